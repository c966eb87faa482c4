"""An STM32G474RE on its NUCLEO board: memory, peripherals and time around the processor.

Time is virtual and a function of what the program does: an instruction takes 1.3 cycles, a wait for
an interrupt takes until the next one.
"""

from elftools.elf.elffile import ELFFile
from unicorn import UC_PROT_EXEC, UC_PROT_READ

from clocks import BY_POWER, BY_SOFTWARE, BY_WATCHDOG, Clocks, Pins, Registers
from fdcan import MESSAGE_RAM, Controller
from flash import BANK, BANK_SIZE, Flash
from processor import SYSTEM_CONTROL, Processor, Stuck
from timers import SECOND, Timer, Watchdog

FLASH, RAM, RAM_SIZE = 0x08000000, 0x20000000, 128 * 1024
UNIQUE_ID, FLASH_SIZE = 0x1FFF7590, 0x1FFF75E0
ANYTHING = b"\xa5"
MESSAGES = 0x4000A400
# Where reads and writes are a peripheral's; the message RAM lies between.
PERIPHERALS = [
    (0x40000000, 0xA000),
    (0x4000B000, 0x19000),
    (0x48000000, 0x2000),
    (0xE0000000, 0x100000),
]
STACK_ENDS = ("_stack_end", "_stack_start")
BLOCK = 0x400  # every peripheral begins at a multiple of that

SLICE = 85  # instructions
CYCLES = 110  # of a slice


class Chip:
    """The chip with its image, without power until `power_on`."""

    def __init__(self, image, unique_id):
        self.processor = Processor()
        self.now = 0
        self.watchdog_bites = False
        self.resets = []  # (when, cause)
        self._memory(image, unique_id)

        power = Registers({0x00: 0x200, 0x80: 0x100})
        self.flash = Flash(self)
        self.clocks = Clocks(power, self.flash, lambda: self.timer.change_clock())
        self.timer = Timer(self, interrupt=24)
        self.watchdog = Watchdog(self)
        self.pins = {name: Pins({0x00: 0xFFFFFFFF}) for name in "ABCDEFG"}
        self.pins["A"].initial[0x00] = 0xABFFFFFF
        self.pins["B"].initial[0x00] = 0xFFFFFEBF

        def wired(port, *pins):
            return lambda: all(self.pins[port].has_function(pin, 9) for pin in pins)

        self.host = Controller(self, MESSAGES, (21, 22), wired("A", 11, 12))
        drives = MESSAGES + MESSAGE_RAM
        self.drives = Controller(self, drives, (86, 87), wired("B", 12, 13))

        # Peripheral, where it begins, and the bit that gives it its clock.
        parts = [
            (self.watchdog, 0x40003000, None),
            (self.host, 0x40006400, (0x58, 25)),
            (self.drives, 0x40006800, (0x58, 25)),
            (power, 0x40007000, (0x58, 28)),
            (Registers(), 0x40010000, (0x60, 0)),  # SYSCFG
            (Registers(), 0x40010400, None),  # EXTI
            (self.timer, 0x40014000, (0x60, 16)),
            (Registers(), 0x40020000, (0x48, 0)),  # DMA1
            (Registers(), 0x40020400, (0x48, 1)),  # DMA2
            (Registers(), 0x40020800, (0x48, 2)),  # DMAMUX
            (self.clocks, 0x40021000, None),
            (self.flash, 0x40022000, (0x48, 8)),
            (Registers(), 0xE0042000, None),  # DBGMCU
        ]
        for number, port in enumerate(self.pins.values()):
            parts.append((port, 0x48000000 + BLOCK * number, (0x4C, number)))
        self.parts = {
            base // BLOCK: (part, base, enable) for part, base, enable in parts
        }
        for block in range(SYSTEM_CONTROL // BLOCK, SYSTEM_CONTROL // BLOCK + 4):
            self.parts[block] = (self.processor, SYSTEM_CONTROL, None)
        self.clocks.at_reset = {
            enable: part
            for part, _, enable in parts
            if enable and part is not self.host
        }
        self.timed = (self.timer, self.watchdog)

    def _memory(self, image, unique_id):
        unicorn = self.processor.unicorn
        unicorn.mem_map(FLASH, BANK - FLASH, UC_PROT_READ | UC_PROT_EXEC)
        unicorn.mem_map(RAM, RAM_SIZE)
        unicorn.mem_map(UNIQUE_ID & ~0xFFF, 0x1000, UC_PROT_READ)
        unicorn.mem_map(MESSAGES & ~0xFFF, 0x1000)
        for base, size in PERIPHERALS:
            unicorn.mmio_map(base, size, self._read, base, self._write, base)
        unicorn.mmio_map(BANK, BANK_SIZE, self._read_bank, None, self._write_bank, None)
        # After power-on, RAM holds anything.
        unicorn.mem_write(RAM, ANYTHING * RAM_SIZE)
        unicorn.mem_write(UNIQUE_ID, unique_id)
        unicorn.mem_write(FLASH_SIZE, (512).to_bytes(2, "little"))
        unicorn.mem_write(FLASH, b"\xff" * (BANK - FLASH))
        with open(image, "rb") as file:
            elf = ELFFile(file)
            for segment in elf.iter_segments("PT_LOAD"):
                if segment["p_filesz"]:
                    unicorn.mem_write(segment["p_paddr"], segment.data())
            symbols = elf.get_section_by_name(".symtab")
            ends = [symbols.get_symbol_by_name(name)[0] for name in STACK_ENDS]
        self.stack_ends = [symbol["st_value"] for symbol in ends]

    def stack(self):
        """Bytes of the stack that were ever used, and that there are."""
        low, high = self.stack_ends
        used = self.memory(low, high - low).lstrip(ANYTHING)
        return len(used), high - low

    def memory(self, address, size):
        """Bytes of memory."""
        return self.processor.unicorn.mem_read(address, size)

    def set_memory(self, address, data):
        """Changes bytes of memory."""
        self.processor.unicorn.mem_write(address, data)

    def _read(self, _, offset, size, base):
        address = base + offset
        part, begin, enable = self._part(address)
        if not self.clocks.is_enabled(enable):
            raise Stuck(f"{address:#x} is read without its clock, by {self._place()}")
        word = part.read(address - begin & ~3)
        return word >> 8 * (address & 3) & (1 << 8 * size) - 1

    def _write(self, _, offset, size, value, base):
        address = base + offset
        part, begin, enable = self._part(address)
        if not self.clocks.is_enabled(enable):
            raise Stuck(
                f"{address:#x} is written without its clock, by {self._place()}"
            )
        register, shift = address - begin & ~3, 8 * (address & 3)
        if size < 4:
            mask = (1 << 8 * size) - 1 << shift
            value = part.read(register) & ~mask | value << shift & mask
        part.write(register, value)
        self.changed = True

    def _part(self, address):
        part = self.parts.get(address // BLOCK)
        if part is None:
            raise Stuck(
                f"{address:#x} is used by {self._place()}, and nothing is modelled there"
            )
        return part

    def _place(self):
        return f"code that {self.processor.caller():#x} called"

    def _read_bank(self, _, offset, size, __):
        word = self.flash.read_bank(offset & ~3)
        return word >> 8 * (offset & 3) & (1 << 8 * size) - 1

    def _write_bank(self, _, offset, size, value, __):
        if size != 4:
            raise Stuck(f"flash is written with {size} bytes at a time")
        self.flash.write_bank(offset, value)

    # Time.

    def power_on(self):
        """The first reset."""
        self._reset(BY_POWER)

    def press_reset(self):
        """The board's black button."""
        self._reset(0)

    def _reset(self, cause):
        self.resets.append((self.now, cause))
        self.watchdog_bites = False
        for part, _, _ in self.parts.values():
            if part not in (self.processor, self.clocks):
                part.reset()
        self.clocks.restart(cause)
        self.processor.reset()
        self.asleep, self.changed = False, True

    def run(self, end, until=None):
        """Goes on until this time in ns, or until `until()` is true, which is asked at every event."""
        processor = self.processor
        while self.now < end:
            if self.changed or self.now >= self.due:
                self._events()
                if self.watchdog_bites:
                    self._reset(BY_WATCHDOG)
                if until and until():
                    return True
            if processor.take_interrupt():
                self.asleep = False
            if self.asleep and not processor.wakes():
                self.now = min(end, max(self.now, self.due))
                continue
            self.asleep = processor.run(SLICE)
            # One that slept or was interrupted ended early: half of it, on the whole.
            early = self.asleep or self.changed
            self.now += (
                CYCLES * SECOND // self.clocks.processor() // (2 if early else 1)
            )
            if processor.reset_requested:
                self._reset(BY_SOFTWARE)
        return False

    def _events(self):
        self.changed = False
        for part in self.timed:
            part.advance()
        dues = [part.next() for part in self.timed]
        for controller in (self.host, self.drives):
            controller.bus.advance(self.now, controller)
            dues.append(controller.bus.next(controller))
        self.due = min(
            (due for due in dues if due is not None), default=self.now + SECOND
        )
