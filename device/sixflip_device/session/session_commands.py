"""What the host may ask for while a session is under way: redo, undo, and what is always so."""

from sixflip.poses.faces import FACES, face_of_code, pose_name


def obey(command, unit, session, store, teller):
    cmd = command["cmd"]
    placements = session.placements
    if cmd == "redo" and command.get("face") in FACES:
        _redo(FACES.index(command["face"]), session, store, teller)
    elif cmd == "redo":
        unit.events.error("redo without a face", "one of " + " ".join(FACES))
    elif cmd == "undo" and placements and session.wanted:
        gone = session.undo()  # of a pose that may come more than once
        store.withdraw(gone.pose, gone.first)
        teller.redo(pose_name(gone.pose))
    elif cmd == "undo" and placements:
        _redo(face_of_code(placements[-1].pose), session, store, teller)
    elif cmd == "undo":
        unit.events.error("nothing to undo", "an accepted pose")
    elif cmd == "record" and store.recorded:
        store.header_again()
    else:
        unit.obey(command, True)


def _redo(face, session, store, teller):
    """Both poses of the face are taken again."""
    session.redo(face)
    for code in session.withdrawn:
        store.withdraw(code)
    del session.withdrawn[:]
    teller.redo(FACES[face])
