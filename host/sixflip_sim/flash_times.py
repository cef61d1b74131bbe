"""How long a flash keeps its processor waiting: nothing else runs on a Pico meanwhile.

Winbond W25Q16JV, the Pico's flash, typical times of its table 9.6 (tSE, tBE2, tPP).
"""

SECTOR = 4096
BLOCK = 65536
PAGE = 256
SECTOR_ERASE_US = 45000
BLOCK_ERASE_US = 150000
PAGE_US = 400
