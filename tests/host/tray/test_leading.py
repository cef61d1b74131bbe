"""A tray by its events: what the person is asked for, and who holds up whom (nobody anybody)."""

import itertools

import pytest

from sixflip_host.board.event_words import GUIDED_ORDER
from sixflip_host.tray import leading
from sixflip_host.tray.jig import AS_THE_JIG, FACES, across, jig_to_own, learned
from sixflip_host.virtual.jig_hand import WAYS
from tests.worlds.tray_rig import LIE_S, Rig, ScriptedBoard

UPSIDE_DOWN = WAYS[1]


def verdicts(rig):
    return {member.port: member.state.verdict for member in rig.tray.members if not member.gone}


def all_ways():
    """The 24 ways in which a board can lie in a jig, by where its Z+ and X+ are."""
    for z, x in itertools.permutations(FACES, 2):
        if z[0] != x[0]:
            yield learned(learned({}, "Z+", z), "X+", x)


def test_two_rests_tell_how_a_board_lies_in_the_jig():
    ways = list(all_ways())
    assert len({tuple(sorted(way.items())) for way in ways}) == 24
    for way in ways:
        assert sorted(way) == sorted(way.values()) == sorted(FACES)
        assert way[across("Z+", "X+")] == across(way["Z+"], way["X+"])
    assert learned(AS_THE_JIG, "Z+", "X+") == {"Z+": "X+", "Z-": "X-"}     # it came loose


def test_eight_boards_in_eight_ways_are_led_together_through_one_round():
    ways = [AS_THE_JIG, *list(all_ways())[::3][:7]]
    rig = Rig({"p%d" % k: ScriptedBoard(way) for k, way in enumerate(ways)}).play()
    assert rig.laid == GUIDED_ORDER
    assert set(verdicts(rig).values()) == {"good"} and len(verdicts(rig)) == 8
    assert [member.mounting for member in rig.tray.members] == ways
    assert not rig.told


@pytest.mark.parametrize("missed, again", [(2, "X+a X+b"), (3, "X+a X+b"), (0, "Z+a Z+b"),
                                           (11, "Y-a")])        # as it lies, and turned
def test_who_misses_a_pose_is_asked_for_its_face_at_the_end(missed, again):
    rig = Rig({"p": ScriptedBoard(), "q": ScriptedBoard(UPSIDE_DOWN, misses=[missed]),
               "r": ScriptedBoard(WAYS[2])}).play()
    assert set(verdicts(rig).values()) == {"good"} and len(verdicts(rig)) == 3
    assert rig.laid == GUIDED_ORDER + again.split()
    face = jig_to_own(UPSIDE_DOWN)[again[:2]]
    assert rig.told == [("q", {"cmd": "redo", "face": face})]
    line = next(line for line in rig.tray.log if "not taken" in line)
    assert line.startswith("2 (idq): %s" % again[:2]) and "at the end" in line


def test_a_board_that_is_unplugged_leaves_and_the_others_go_on():
    rig = Rig({"p": ScriptedBoard(lost_at=5), "q": ScriptedBoard(UPSIDE_DOWN),
               "r": ScriptedBoard()}).play()
    assert rig.laid == GUIDED_ORDER and verdicts(rig) == {"q": "good", "r": "good"}
    assert rig.member("p").gone == "the board went away"
    assert "1 (idp) leaves the tray: the board went away" in rig.tray.log


@pytest.mark.parametrize("stuck_from", [0, 2, 5])
def test_a_stuck_board_leaves_after_three_faces_and_holds_nobody_up(stuck_from):
    """Even where it is the one that names the jig's faces."""
    rig = Rig({"p": ScriptedBoard(stuck_from=stuck_from), "q": ScriptedBoard(UPSIDE_DOWN),
               "r": ScriptedBoard(WAYS[3])}).play()
    assert rig.laid == GUIDED_ORDER and verdicts(rig) == {"q": "good", "r": "good"}
    assert "the readings do not change" in rig.member("p").gone
    assert rig.told == [("p", {"cmd": "stop"})]


def test_those_who_have_it_wait_for_a_capture_under_way_but_not_for_a_stuck_chip():
    rig = Rig({port: ScriptedBoard() for port in "pqr"})
    rig.hear("p", rig.boards["p"].lay(0, "Z+a"))
    rig.hear("q", rig.boards["q"].lay(0, "Z+a")[:2])        # it captures
    rig.boards["r"].stuck_from = 0
    rig.hear("r", rig.boards["r"].lay(0, "Z+a"))
    rig.take(leading.tick(rig.tray, leading.PATIENCE_S - 1))
    assert rig.tray.letter == "a"
    rig.hear("q", [{"event": "pose", "pose": "Z+a", "missing": rig.boards["q"].missing}])
    assert rig.tray.letter == "b"


def test_another_firmware_leaves_the_tray_and_is_told_to_stop():
    rig = Rig({"p": ScriptedBoard(firmware="0.0.1"), "q": ScriptedBoard()}).play()
    assert rig.laid == GUIDED_ORDER and verdicts(rig) == {"q": "good"}
    assert rig.member("p").gone.startswith("its firmware is 0.0.1, expected ")
    assert rig.told == [("p", {"cmd": "stop"})]


@pytest.mark.parametrize("event, says", [
    ({"event": "misfit", "of": "pose", "why": "pose: pose is 3"}, "firmware of this version"),
    ({"event": "error", "what": "no usable sensor: nothing answers", "expected": "an MPU6050"},
     "expected an MPU6050"),
    ({"event": "ready"}, "no session began")])
def test_a_board_without_a_session_leaves(event, says):
    rig = Rig({"p": ScriptedBoard(says=[event]), "q": ScriptedBoard()})
    assert says in rig.member("p").gone
    assert verdicts(rig.play()) == {"q": "good"}


def test_a_board_that_does_not_begin_holds_the_others_up_for_a_while_only():
    rig = Rig({"p": ScriptedBoard(says=[]), "q": ScriptedBoard()})
    assert not rig.tray.face and not rig.tray.over
    rig.take(leading.tick(rig.tray, leading.START_S - 1))
    assert not rig.tray.face
    rig.take(leading.tick(rig.tray, leading.START_S + 1))
    assert rig.tray.face == "Z+"


def test_the_person_may_lay_the_jig_in_another_order():
    """What is asked for follows; the first rest tells where the jig's Z+ is."""
    rig = Rig({"p": ScriptedBoard(), "q": ScriptedBoard(UPSIDE_DOWN)})
    for pose in ("Y-a", "Y-b", "X-a", "X-b"):
        rig.lay(pose)
    assert rig.tray.face == "Z+"
    rig.play()
    assert len(rig.laid) == 12 and set(verdicts(rig).values()) == {"good"}


def test_a_face_again_for_all_by_each_ones_own_name():
    rig = Rig({"p": ScriptedBoard(), "q": ScriptedBoard(UPSIDE_DOWN)})
    for pose in GUIDED_ORDER[:5]:
        rig.lay(pose)
    rig.take(leading.redo(rig.tray, "Z+", rig.now))
    assert rig.told == [("p", {"cmd": "redo", "face": "Z+"}), ("q", {"cmd": "redo", "face": "Z-"})]
    assert rig.asked() == "Z+a" and rig.tray.log[-1] == "next: lay the jig down with Z+ up"
    rig.lay("Z+a")
    rig.take(leading.undo(rig.tray, rig.now))       # of what was laid last, as it lies
    assert rig.tray.log[-2] == "next: Z+ again, as the jig lies"
    rig.play()
    assert set(verdicts(rig).values()) == {"good"}


def test_boards_go_on_with_what_they_have():
    rest = [pose for pose in GUIDED_ORDER if pose[0] == "Y"]
    rig = Rig({"p": ScriptedBoard(missing=rest), "q": ScriptedBoard(UPSIDE_DOWN, missing=rest),
               "r": ScriptedBoard(missing=["Y-b"])}).play()
    assert len(verdicts(rig)) == 3 and set(verdicts(rig).values()) == {"good"}
    assert rig.told == [("r", {"cmd": "redo", "face": "Y-"})]
    assert len(rig.laid) <= 6


def test_a_board_that_had_a_face_whole_before_another_began_is_known_to_lie_on_it():
    rig = Rig({"p": ScriptedBoard(says=[]), "q": ScriptedBoard(UPSIDE_DOWN)})
    for port, face in {"p": "Z+", "q": "Z-"}.items():
        rig.boards[port].missing = [pose for pose in GUIDED_ORDER if pose[:2] != face]
    rig.hear("q", rig.boards["q"].hello("q")[1:])
    *_, lies = said = rig.boards["q"].lay(0, "Z+a")
    rig.hear("q", said)
    rig.boards["p"].says = None
    rig.hear("p", rig.boards["p"].hello("p"))
    assert rig.tray.face == "Z+" and not rig.tray.member("q").mounting
    rig.hear("p", [{"event": "state", "state": "measuring noise", "live": [0, 0, 1000, 0, 0, 0]}])
    rig.hear("q", [lies])
    assert rig.tray.member("q").mounting == {"Z-": "Z+", "Z+": "Z-"}
    assert rig.tray.face == "X+"
    rig.play()
    assert set(verdicts(rig).values()) == {"good"}
    assert not any("Z+ taken" in line for line in rig.tray.log)


def test_a_board_that_does_not_turn_with_the_jig_is_named():
    rig = Rig({port: ScriptedBoard() for port in "pqr"})
    for pose in GUIDED_ORDER[:4]:
        rig.lay(pose)
    rig.boards["r"].mounting = WAYS[2]
    rig.lay("Y+a")
    assert "3 (idr) does not turn with the others: is it loose in the jig?" in rig.tray.log
    rig.play()
    assert verdicts(rig)["p"] == verdicts(rig)["q"] == "good"


def test_a_board_that_was_silent_while_the_jig_was_turned_does_not_make_another_seem_loose():
    rig = Rig({"p": ScriptedBoard(), "q": ScriptedBoard(UPSIDE_DOWN)})
    for pose in GUIDED_ORDER[:2]:
        rig.lay(pose)
    rig.take(leading.redo(rig.tray, "Z+", rig.now))     # q stays silent: the person goes on
    rig.now += LIE_S
    rig.hear("p", rig.boards["p"].lay(3, "X+a"))
    assert rig.tray.face == "X+" and rig.tray.member("p").mounting == AS_THE_JIG
    assert not any("loose" in line for line in rig.tray.log)
    rig.play()
    assert set(verdicts(rig).values()) == {"good"}


def test_a_face_again_when_all_are_done():
    rig = Rig({"p": ScriptedBoard(), "q": ScriptedBoard(UPSIDE_DOWN)}).play()
    rig.take(leading.redo(rig.tray, "X+", rig.now))
    assert rig.told == [("p", {"cmd": "redo", "face": "X+"}), ("q", {"cmd": "redo", "face": "X+"})]
    assert not rig.tray.over and rig.tray.face == "X+"
    for port in rig.boards:
        rig.hear(port, [{"event": "calibrating", "missing": ["X+a", "X+b"]}])
    rig.play()
    assert rig.laid == GUIDED_ORDER + ["X+a", "X+b"]
    assert verdicts(rig) == {"p": "good", "q": "good"}


def test_boards_without_a_gyro_are_lifted_for_the_half_turn():
    rig = Rig({"p": ScriptedBoard(), "q": ScriptedBoard(gyro=False)})
    rig.lay("Z+a")
    assert rig.tray.log[-1].endswith("half a turn, lifted and put down again, Z+ stays up")


def test_a_capture_that_says_it_takes_for_ever_is_not_waited_for():
    rig = Rig({"p": ScriptedBoard(), "q": ScriptedBoard()})
    rig.hear("p", rig.boards["p"].lay(0, "Z+a"))
    for state in ("capturing", "moving") * 5:
        rig.hear("q", [{"event": "state", "state": state, "left_s": 1e6}])
    rig.take(leading.tick(rig.tray, 62))
    assert rig.tray.letter == "b"


def test_a_board_that_hangs_is_said_to_be_silent():
    rig = Rig({"p": ScriptedBoard(), "q": ScriptedBoard()})
    rig.lay("Z+a")
    rig.lay("Z+b")
    rig.now += 10
    rig.hear("p", rig.boards["p"].lay(2, "X+a"))
    rig.take(leading.tick(rig.tray, rig.now + leading.PATIENCE_S))
    assert any(line.startswith("2 (idq): X+ not taken: it has said nothing for ")
               for line in rig.tray.log)


@pytest.mark.parametrize("face", ["Z+", "Y-"])
def test_a_board_that_takes_its_first_pose_before_another_has_begun(face):
    """The others have their time to begin; then the jig's first face is the one it lies on."""
    rig = Rig({"p": ScriptedBoard(), "q": ScriptedBoard(UPSIDE_DOWN, says=[])})
    rig.hear("p", rig.boards["p"].lay(0, face + "a"))
    assert not rig.tray.face and not rig.tray.reference
    rig.boards["q"].says = None
    rig.hear("q", rig.boards["q"].hello("q"))
    assert (rig.tray.face, rig.tray.letter, rig.tray.reference) == (face, "a", "p")
    rig.hear("q", rig.boards["q"].lay(0, face + "a"))
    assert (rig.tray.face, rig.tray.letter) == (face, "b")
    rig.laid.append(face + "a")
    rig.play()
    assert len(rig.laid) == 12 and verdicts(rig) == {"p": "good", "q": "good"}
    assert rig.member("q").mounting == UPSIDE_DOWN


def test_a_board_that_still_learns_its_noise_is_waited_for():
    rig = Rig({"p": ScriptedBoard(), "q": ScriptedBoard()})
    rig.hear("p", rig.boards["p"].lay(0, "Z+a"))
    for rig.now in range(1, 30):
        rig.hear("q", [{"event": "state", "state": "measuring noise"}])
        assert (rig.tray.letter == "a") == (rig.now < leading.START_S)


def test_who_never_takes_a_face_does_not_keep_the_others_from_theirs():
    rig = Rig({"p": ScriptedBoard(misses=[2]), "q": ScriptedBoard(never=["Z+"])})
    while not rig.member("p").over:
        assert len(rig.laid) < 20, rig.tray.log
        rig.lay(rig.asked())
    assert rig.member("p").state.verdict == "good" and rig.laid[-2:] == ["X+a", "X+b"]


def test_a_board_that_tells_late_of_what_it_took_back_is_asked_for_it_and_has_missed_nothing():
    rig = Rig({"p": ScriptedBoard(), "q": ScriptedBoard()})
    rig.lay("Z+a")
    assert rig.tray.letter == "b"
    rig.boards["q"].jig = ""        # it is lifted when it hears of it
    rig.hear("q", rig.boards["q"].obey(0, {"cmd": "redo", "face": "Z+"}))
    rig.hear("p", rig.boards["p"].lay(1, "Z+b"))
    assert (rig.tray.face, rig.tray.letter, rig.member("q").missed) == ("Z+", "a", 0)
    assert [one.port for one in rig.tray.awaited()] == ["q"] and not rig.told
    rig.play()
    assert verdicts(rig) == {"p": "good", "q": "good"}
