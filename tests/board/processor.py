"""A Cortex-M4F: unicorn executes instructions, what it leaves out is here: exceptions and the NVIC.

Faults are not taken: a program that causes one, or an exception that is not modelled, ends the run with
an error that says where.
"""

from unicorn import (
    UC_ARCH_ARM,
    UC_HOOK_INTR,
    UC_MODE_MCLASS,
    UC_MODE_THUMB,
    Uc,
    UcError,
)
from unicorn import arm_const as arm

SYSTEM_CONTROL = 0xE000E000  # where its registers are, of which four KiB are known here
INTERRUPTS = 102  # of an STM32G474
FIRST_INTERRUPT = 16  # the number of its exception

INTERRUPT_CONTROL_STATE = 0xD04
VECTOR_TABLE = 0xD08
APPLICATION_RESET = 0xD0C
SOFTWARE_TRIGGER = 0xF00
RESET_KEY = 0x05FA0000
RESET_REQUEST = 1 << 2
# SCB, CPACR, the debugger's and the floating-point unit's: they hold what is written.
PLAIN = (0xD00, 0xD10, 0xD20, 0xD80, 0xD90, 0xDA0, 0xDF0, 0xF30)
PRIORITY_BITS = 0xF0  # the upper 4 of 8

RETURN_BY_HOOK = (
    8  # what unicorn calls a jump to an address that means: return from the exception
)
TO_HANDLER, TO_THREAD = (
    0xFFFFFFE1,
    0xFFFFFFE9,
)  # with the floating-point registers on the main stack
WAIT_FOR_INTERRUPT = b"\x30\xbf"

STACKED = [
    arm.UC_ARM_REG_R0,
    arm.UC_ARM_REG_R1,
    arm.UC_ARM_REG_R2,
    arm.UC_ARM_REG_R3,
    arm.UC_ARM_REG_R12,
    arm.UC_ARM_REG_LR,
    arm.UC_ARM_REG_PC,
    arm.UC_ARM_REG_XPSR,
    *range(arm.UC_ARM_REG_S0, arm.UC_ARM_REG_S0 + 16),
    arm.UC_ARM_REG_FPSCR,
]
FRAME = 4 * (len(STACKED) + 1)  # one word is reserved
STATUS = 7
THUMB, PADDED, NUMBER = 1 << 24, 1 << 9, 0x1FF


class Stuck(Exception):
    """The program did what no program should."""


class Processor:
    """Registers, exceptions and their priorities. Memory is the chip's."""

    def __init__(self):
        self.unicorn = Uc(UC_ARCH_ARM, UC_MODE_THUMB | UC_MODE_MCLASS)
        self.unicorn.ctl_set_cpu_model(arm.UC_CPU_ARM_CORTEX_M4)
        self.unicorn.hook_add(UC_HOOK_INTR, self._exception)
        self.reset_requested = False
        self._returns = False

    def reset(self):
        """Begins at the vector table's entry, with nothing enabled."""
        self.words = {}
        self.enabled = set()
        self.pending = set()
        self.active = []
        self.priorities = bytearray(FIRST_INTERRUPT + INTERRUPTS)
        self.lines = set()
        self.reset_requested = False
        self._returns = False
        unicorn = self.unicorn
        for register in (
            arm.UC_ARM_REG_PRIMASK,
            arm.UC_ARM_REG_BASEPRI,
            arm.UC_ARM_REG_FAULTMASK,
        ):
            unicorn.reg_write(register, 0)
        unicorn.reg_write(arm.UC_ARM_REG_XPSR, THUMB)
        unicorn.reg_write(arm.UC_ARM_REG_SP, self.word(self.vectors()))
        self.place = self.word(self.vectors() + 4) & ~1

    def vectors(self):
        """Where the vector table is."""
        return self.words.get(VECTOR_TABLE, 0x08000000)

    def word(self, address):
        """A word of memory."""
        return int.from_bytes(self.unicorn.mem_read(address, 4), "little")

    def run(self, instructions):
        """Executes about so many; says whether it then waits for an interrupt."""
        try:
            self.unicorn.emu_start(self.place | 1, 0, count=instructions)
        except UcError as error:
            place = self.unicorn.reg_read(arm.UC_ARM_REG_PC)
            raise Stuck(
                f"{error} at {place:#x}, called from {self.caller():#x}"
            ) from error
        self.place = self.unicorn.reg_read(arm.UC_ARM_REG_PC)
        if self._returns:
            self._returns = False
            self._leave()
            return False
        return self.unicorn.mem_read(self.place - 2, 2) == WAIT_FOR_INTERRUPT

    def caller(self):
        """The link register."""
        return self.unicorn.reg_read(arm.UC_ARM_REG_LR)

    # Interrupts.

    def set_line(self, interrupt, high):
        """A peripheral's request: as long as it is there, the interrupt becomes pending again."""
        if not high:
            self.lines.discard(interrupt)
        elif interrupt not in self.lines:
            self.lines.add(interrupt)
            self.pending.add(interrupt)

    def _candidate(self):
        """The most urgent interrupt that is enabled and pending, with its priority."""
        ready = self.pending & self.enabled
        if not ready:
            return None, 256
        first = min(ready, key=lambda n: (self.priorities[FIRST_INTERRUPT + n], n))
        return first, self.priorities[FIRST_INTERRUPT + first]

    def _level(self):
        levels = (self.priorities[number] for number in self.active)
        return min(levels, default=256)

    def wakes(self):
        """Whether an interrupt ends the wait for one: PRIMASK does not count."""
        base = self.unicorn.reg_read(arm.UC_ARM_REG_BASEPRI) or 256
        return self._candidate()[1] < min(base, self._level())

    def take_interrupt(self):
        """Enters the handler of the most urgent interrupt, if it is allowed now."""
        if not self.pending:
            return False
        interrupt, priority = self._candidate()
        if priority >= self._level():
            return False
        masks = (arm.UC_ARM_REG_PRIMASK, arm.UC_ARM_REG_FAULTMASK)
        base = self.unicorn.reg_read(arm.UC_ARM_REG_BASEPRI)
        if (base and priority >= base) or any(map(self.unicorn.reg_read, masks)):
            return False
        self.pending.discard(interrupt)
        self._enter(FIRST_INTERRUPT + interrupt)
        return True

    def _enter(self, number):
        unicorn = self.unicorn
        stack = unicorn.reg_read(arm.UC_ARM_REG_SP)
        values = list(unicorn.reg_read_batch(STACKED))
        values[6] = self.place
        values[STATUS] &= ~PADDED
        if stack & 4:
            values[STATUS] |= PADDED
            stack -= 4
        stack -= FRAME
        frame = b"".join(value.to_bytes(4, "little") for value in values)
        unicorn.mem_write(stack, frame + bytes(4))
        unicorn.reg_write(arm.UC_ARM_REG_SP, stack)
        unicorn.reg_write(arm.UC_ARM_REG_LR, TO_HANDLER if self.active else TO_THREAD)
        unicorn.reg_write(arm.UC_ARM_REG_XPSR, THUMB | number)
        self.active.append(number)
        self.place = self.word(self.vectors() + 4 * number) & ~1

    def _leave(self):
        unicorn = self.unicorn
        number = self.active.pop()
        wanted = TO_HANDLER if self.active else TO_THREAD
        if self.place | 1 != wanted:
            raise Stuck(
                f"exception {number} ends with {self.place | 1:#x} and not {wanted:#x}"
            )
        stack = unicorn.reg_read(arm.UC_ARM_REG_SP)
        frame = unicorn.mem_read(stack, FRAME)
        words = range(0, FRAME - 4, 4)
        values = [int.from_bytes(frame[at : at + 4], "little") for at in words]
        stack += FRAME + (4 if values[STATUS] & PADDED else 0)
        values[STATUS] &= ~PADDED
        if values[STATUS] & NUMBER != (self.active[-1] if self.active else 0):
            raise Stuck(f"the stack of exception {number} was overwritten")
        self.place = values[6]
        for register, value in zip(STACKED, values):
            unicorn.reg_write(register, value)
        unicorn.reg_write(arm.UC_ARM_REG_SP, stack)
        interrupt = number - FIRST_INTERRUPT
        if interrupt in self.lines:
            self.pending.add(interrupt)

    def _exception(self, unicorn, number, _):
        if number == RETURN_BY_HOOK and self.active:
            self._returns = True
        else:
            place = unicorn.reg_read(arm.UC_ARM_REG_PC)
            raise Stuck(f"exception {number} of the processor at {place:#x}")
        unicorn.emu_stop()

    # The registers of system control.

    def read(self, offset):
        """A register of system control."""
        register, first = offset & ~0xF, 8 * (offset & 0x1F)
        if 0x100 <= offset < 0x200:
            return _bits(self.enabled, first)
        if 0x200 <= offset < 0x300:
            return _bits(self.pending, first)
        if 0x400 <= offset < 0x400 + INTERRUPTS:
            at = FIRST_INTERRUPT + offset - 0x400
            return int.from_bytes(self.priorities[at : at + 4], "little")
        if offset == INTERRUPT_CONTROL_STATE:
            return self.active[-1] if self.active else 0
        if offset == VECTOR_TABLE:
            return self.vectors()
        if register in PLAIN:
            return self.words.get(offset, 0)
        raise Stuck(f"system control has no register {offset:#x} here")

    def write(self, offset, value):
        """Writes a register of system control."""
        numbers = _numbers(value, 8 * (offset & 0x1F) if offset < 0x400 else 0)
        if 0x100 <= offset < 0x180:
            self.enabled.update(numbers)
        elif 0x180 <= offset < 0x200:
            self.enabled.difference_update(numbers)
        elif 0x200 <= offset < 0x280:
            self.pending.update(numbers)
        elif 0x280 <= offset < 0x300:
            # A request that is still there comes back.
            self.pending.difference_update(n for n in numbers if n not in self.lines)
        elif 0x400 <= offset < 0x400 + INTERRUPTS:
            at = FIRST_INTERRUPT + offset - 0x400
            self.priorities[at : at + 4] = bytes(
                byte & PRIORITY_BITS for byte in value.to_bytes(4, "little")
            )
        elif offset == SOFTWARE_TRIGGER:
            self.pending.add(value & 0x1FF)
        elif (
            offset == APPLICATION_RESET and value & ~0x700 == RESET_KEY | RESET_REQUEST
        ):
            self.reset_requested = True
        elif offset & ~0xF in PLAIN and offset != INTERRUPT_CONTROL_STATE:
            self.words[offset] = value
        else:
            raise Stuck(f"system control has no register {offset:#x} here")


def _bits(numbers, first):
    return sum(1 << n - first for n in numbers if first <= n < first + 32)


def _numbers(value, first):
    return [first + bit for bit in range(32) if value >> bit & 1]
