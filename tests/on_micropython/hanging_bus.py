"""The bus hangs once before the last pose, where the heap is fullest, until it is freed.

The chip comes back with its registers at zero.
"""


def install(board, power_up):
    chips = board.i2c
    state = [-1, False]  # reads until it hangs; it hangs
    write_line = board.write_line
    read = chips.readfrom_mem_into

    def told(text):
        if '"pose", "pose": "Y-a' in text:
            state[0] = 150  # while it is flipped
        write_line(text)

    def reopen():
        if state[1]:
            state[1] = False
            for c in chips.i2c:
                for register in range(1, 0x75):  # identifications stay
                    if str(register) not in c["identity"]:
                        c["registers"][register] = 0
        return chips

    def read_or_hang(address, register, buf):
        if state[0] >= 0:
            state[0] -= 1
            state[1] = state[0] < 0
        if state[1]:
            raise OSError(110)
        read(address, register, buf)

    board.write_line = told
    board.reopen_i2c = reopen
    chips.readfrom_mem_into = read_or_hang
