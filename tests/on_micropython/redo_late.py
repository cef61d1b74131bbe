"""A face is asked for again after eleven poses, where the heap is fullest."""


def install(board, power_up):
    write_line, read_line = board.write_line, board.read_line
    lines = []

    def told(text):
        if '"pose", "pose": "Y-a' in text:
            lines.append('{"cmd": "redo", "face": "X-"}')
        write_line(text)

    board.write_line = told
    board.read_line = lambda: lines.pop() if lines else read_line()
