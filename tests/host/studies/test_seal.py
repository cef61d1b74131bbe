"""Seals of the blind check: a label that was changed afterwards is noticed."""

import copy

import pytest

from tests.studies.blind import seal

CASES = [({"id": "case-0000", "files": ["a.csv"], "words": []}, {"effects": ["thermal_bias"]}),
         ({"id": "case-0001", "files": ["b.csv"], "words": []}, {"effects": ["thermal_bias"]})]


def test_what_was_sealed_comes_back_when_opened(tmp_path):
    seal.write(tmp_path, CASES, ["dust lump"])
    assert seal.opened(tmp_path) == {public["id"]: label for public, label in CASES}


def test_the_manifest_says_nothing_of_the_labels(tmp_path):
    seal.write(tmp_path, CASES, ["dust lump"])
    text = (tmp_path / seal.MANIFEST).read_text()
    assert "thermal_bias" not in text and "dust" not in text
    manifest, _ = seal.sealed(CASES)
    first, second = (case["label_sha256"] for case in manifest["cases"])
    assert first != second      # equal labels do not show as equal


@pytest.mark.parametrize("harm", ["label", "salt", "missing", "swapped", "families", "twice"])
def test_any_change_breaks_the_seal(harm):
    manifest, secret = (copy.deepcopy(x) for x in seal.sealed(
        [(p, {**label, "seed": k}) for k, (p, label) in enumerate(CASES)], ["dust lump"]))
    labels = secret["labels"]
    if harm == "label":
        labels["case-0001"]["label"]["effects"] = ["warm_up"]
    elif harm == "salt":
        labels["case-0000"]["salt"] = "00" * 16
    elif harm == "missing":
        del labels["case-0000"]
    elif harm == "swapped":
        labels["case-0000"], labels["case-0001"] = labels["case-0001"], labels["case-0000"]
    elif harm == "families":
        secret["kept_out"][0]["name"] = "bias step"
    else:
        manifest["cases"].append(manifest["cases"][0])
    with pytest.raises(seal.BrokenSeal):
        seal.checked(manifest, secret)
