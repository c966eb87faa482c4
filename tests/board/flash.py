"""The flash of an STM32G474 with two banks, after RM0440: the program runs from the first, the second is
erased and programmed."""

from clocks import Registers
from processor import Stuck

BANK = 0x08040000
BANK_SIZE = 256 * 1024
PAGE = 2 * 1024

ACCESS, KEY, STATUS, CONTROL, OPTIONS = 0x00, 0x08, 0x10, 0x14, 0x20
KEYS = [0x45670123, 0xCDEF89AB]
PROGRAM, PAGE_ERASE, SECOND_BANK, START, LOCK = (
    1 << 0,
    1 << 1,
    1 << 11,
    1 << 16,
    1 << 31,
)
BUSY = 1 << 16
DUAL_BANK = 1 << 22  # of OPTIONS
# Typical times of the data sheet, in ns.
ERASES, PROGRAMS = 22_000_000, 82_000


class Flash(Registers):
    """The controller, and what the second bank holds, which no reset changes."""

    def __init__(self, chip):
        self.chip = chip
        self.bank = bytearray(b"\xff" * BANK_SIZE)
        self.erased = 0
        # Option bit DBANK is set, as delivered.
        super().__init__({ACCESS: 0x40600, CONTROL: 0xC0000000, OPTIONS: 0xFFEFF8AA})

    def make_one_bank(self):
        """As if somebody had cleared the option bit DBANK."""
        self.initial[OPTIONS] &= ~DUAL_BANK
        self.reset()

    def reset(self):
        super().reset()
        self.keys = []
        self.half = None
        self.done = 0

    def read(self, offset):
        if offset == STATUS:
            return BUSY if self.chip.now < self.done else 0
        return super().read(offset)

    def write(self, offset, value):
        if offset == KEY:
            self.keys = [*self.keys, value][-2:]
            if self.keys == KEYS:
                self.words[CONTROL] &= ~LOCK
        elif offset == CONTROL:
            self._control(value)
        elif offset != STATUS:
            super().write(offset, value)

    def _control(self, value):
        if self.words[CONTROL] & LOCK or self.chip.now < self.done:
            raise Stuck("FLASH_CR is written while it is locked or busy")
        if value & START:
            if not value & PAGE_ERASE or not value & SECOND_BANK or value & PROGRAM:
                raise Stuck(
                    f"FLASH_CR erases something else than a page of bank 2: {value:#x}"
                )
            at = (value >> 3 & 0x7F) * PAGE
            self.bank[at : at + PAGE] = b"\xff" * PAGE
            self.erased += 1
            self.done = self.chip.now + ERASES
        self.words[CONTROL] = value & ~START

    def read_bank(self, offset):
        """A word of the second bank."""
        if self.chip.now < self.done:
            raise Stuck("the bank is read while it is erased or programmed")
        return int.from_bytes(self.bank[offset : offset + 4], "little")

    def write_bank(self, offset, value):
        """Programs half a double word; the second half has it done."""
        writable = self.words[CONTROL] & (PROGRAM | LOCK) == PROGRAM
        if not writable or self.chip.now < self.done:
            raise Stuck(
                f"flash is written at {BANK + offset:#x} and FLASH_CR does not let it"
            )
        if self.half is None and offset % 8 == 0:
            self.half = offset
        elif self.half is not None and offset == self.half + 4:
            self.half = None
            self.done = self.chip.now + PROGRAMS
        else:
            raise Stuck(
                f"flash is written at {BANK + offset:#x}, not a double word at a time"
            )
        if self.bank[offset : offset + 4] != b"\xff" * 4:
            raise Stuck(f"flash is written at {BANK + offset:#x} and was not erased")
        self.bank[offset : offset + 4] = value.to_bytes(4, "little")
