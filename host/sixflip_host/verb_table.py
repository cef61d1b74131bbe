"""The verbs of the command `sixflip`: the module of each, and what it does in one line.

The lines stand here and not in the modules, so that `sixflip --help` loads none of them.
"""

VERBS = {
    "boards": ("sixflip_host.verbs.boards", "list the boards that are plugged in"),
    "provision": (
        "sixflip_host.verbs.provision",
        "copy the firmware onto a board and test its sensor"),
    "calibrate": ("sixflip_host.verbs.calibrate", "calibrate a board now, guided face by face"),
    "ui": (
        "sixflip_host.verbs.ui",
        "the guided calibration in a browser, with the box in 3-D, plots and reports"),
    "pull": (
        "sixflip_host.verbs.pull",
        "fetch the raw capture and the correction records from a board"),
    "verify": (
        "sixflip_host.verbs.verify",
        "recompute everything from the raw capture and compare with the board's record"),
    "solve": (
        "sixflip_host.verbs.solve",
        "solve a capture file with the code that runs on the board"),
    "refine": (
        "sixflip_host.verbs.refine",
        "refine a calibration from all rests and moves of a capture, with uncertainties"),
    "restore": (
        "sixflip_host.verbs.restore",
        "go back to the correction before the present one, or put one from a file into force"),
    "check": (
        "sixflip_host.verbs.check",
        "is the calibration still valid? some seconds of rest against the record"),
    "mount": (
        "sixflip_host.verbs.mount",
        "roll and pitch of an installed sensor, from a rest on a level vehicle"),
    "stream": (
        "sixflip_host.verbs.stream",
        "raw counts, corrected samples or the heading of a board, live"),
    "record": (
        "sixflip_host.verbs.record",
        "write a board's raw samples down for minutes or hours, without a session"),
    "show": (
        "sixflip_host.verbs.show",
        "what is in a record or a capture, or in the flash of a board, in words"),
    "import": (
        "sixflip_host.verbs.import_recording",
        "make a capture file from somebody else's recording (CSV, ROS, PX4, MATLAB and others),"
        " finding the poses by itself"),
    "export": ("sixflip_host.verbs.export", "a capture or a record in another format"),
    "apply": (
        "sixflip_host.verbs.apply",
        "correct a capture with a record: CSV, Parquet, NPZ or MCAP in m/s² and rad/s"),
    "history": (
        "sixflip_host.verbs.history",
        "every calibration and check of a board so far, and how its parameters drift"),
    "report": (
        "sixflip_host.verbs.report",
        "one HTML page with pictures: calibration, verification, history and gap of a board"),
    "doctor": (
        "sixflip_host.verbs.doctor",
        "find out what is wrong: port, MicroPython, wiring, chips, ranges, clock"),
    "plan": (
        "sixflip_host.verbs.plan",
        "say what a capture can tell apart, what it cannot, and what to add; no capture needed"),
    "simulate": (
        "sixflip_host.verbs.simulate",
        "simulate captures: noise, table, hand and any of the known effects, from a scenario "
        "file"),
    "diagnose": (
        "sixflip_host.verbs.diagnose",
        "find what the simulated sensor lacks: where the gap lies, which effect, how far it "
        "shrinks"),
    "fleet": (
        "sixflip_host.verbs.fleet",
        "many boards together: what their batch shares, what single ones have, which stand out"),
    "reproduce": (
        "sixflip_host.verbs.reproduce",
        "the paper's tables and its map as simulated experiments, and whether the claims hold"),
    "demo": (
        "sixflip_host.verbs.demo",
        "watch a virtual board calibrate itself, and check its arithmetic"),
    "virtual-board": (
        "sixflip_host.verbs.virtual_board_verb",
        "run a virtual board and print its serial port"),
    "completion": (
        "sixflip_host.completion",
        "print what makes a shell complete sixflip's command lines"),
}
