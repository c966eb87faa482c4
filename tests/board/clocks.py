"""Clocks, power and resets of an STM32G474, after RM0440, and peripherals that only hold what is written."""

from processor import Stuck

CRYSTAL = 24_000_000  # X3 of the NUCLEO-G474RE
INTERNAL = 16_000_000

CONTROL, CONFIGURATION, PLL = 0x00, 0x08, 0x0C
INTERNAL_ON, CRYSTAL_ON, PLL_ON = 1 << 8, 1 << 16, 1 << 24
PERIPHERAL_CLOCKS, STATUS, FAST_48 = 0x88, 0x94, 0x98
RESETS_FROM_ENABLES = (
    0x20  # a reset register is so far before the one that enables the same
)

# What a reset came from, in STATUS.
REMOVE_FLAGS = 1 << 23
BY_PIN, BY_POWER, BY_SOFTWARE, BY_WATCHDOG = 1 << 26, 1 << 27, 1 << 28, 1 << 29


class Registers:
    """A peripheral of which nothing but its registers matters here."""

    def __init__(self, initial=None):
        self.initial = initial or {}
        self.reset()

    def reset(self):
        """As after the chip's reset, or the peripheral's own."""
        self.words = dict(self.initial)

    def read(self, offset):
        """The register at this offset."""
        return self.words.get(offset, 0)

    def write(self, offset, value):
        """Writes a whole register."""
        self.words[offset] = value


class Pins(Registers):
    """A GPIO port."""

    OUTPUT, SET_OR_CLEAR = 0x14, 0x18

    def write(self, offset, value):
        if offset == self.SET_OR_CLEAR:
            output = self.read(self.OUTPUT) & ~(value >> 16) | value & 0xFFFF
            self.words[self.OUTPUT] = output
        else:
            super().write(offset, value)

    def has_function(self, pin, function):
        """Whether the pin is an alternate function, and that one."""
        mode = self.read(0x00) >> 2 * pin & 3
        chosen = self.read(0x20 + 4 * (pin // 8)) >> 4 * (pin % 8) & 0xF
        return mode == 2 and chosen == function


class Clocks(Registers):
    """RCC. Oscillators and the PLL are ready as soon as they are on."""

    READY = {
        CONTROL: [(INTERNAL_ON, 2), (CRYSTAL_ON, 1), (PLL_ON, 1)],
        STATUS: [(1, 1)],
        FAST_48: [(1, 1)],
    }

    def __init__(self, power, flash, changed):
        self.power, self.flash, self.changed = power, flash, changed
        self.at_reset = {}  # (offset, bit) of an enable register: what is reset
        # HSI runs; the flash's clock is on.
        super().__init__({CONTROL: 0x500, CONFIGURATION: 0x5, PLL: 0x1000, 0x48: 0x100})

    def restart(self, cause):
        """A reset of the chip."""
        flags = self.words.get(STATUS, 0) & 0xFF << 24
        self.reset()
        self.words[STATUS] = flags | cause | BY_PIN

    def is_enabled(self, enable):
        """Whether a peripheral has its clock; `enable` is an offset and a bit."""
        return enable is None or self.read(enable[0]) >> enable[1] & 1

    def write(self, offset, value):
        if offset in self.READY:
            for switch, above in self.READY[offset]:
                ready = switch << above
                value = value & ~ready | (ready if value & switch else 0)
        if offset == STATUS and value & REMOVE_FLAGS:
            value &= 0x3
        if offset == CONFIGURATION:
            value = value & ~0xC | (value & 3) << 2
        for (enable, bit), peripheral in self.at_reset.items():
            if offset == enable - RESETS_FROM_ENABLES and value >> bit & 1:
                peripheral.reset()
        if (
            offset == CONTROL
            and not value & PLL_ON
            and self.read(CONFIGURATION) & 0xC == 0xC
        ):
            raise Stuck("the PLL is switched off under the processor")
        if offset == PLL and self.read(CONTROL) & PLL_ON:
            raise Stuck("the PLL is changed while it runs")
        super().write(offset, value)
        if offset == CONFIGURATION:
            self.changed()

    def source(self):
        """SYSCLK in Hz."""
        source = self.read(CONFIGURATION) >> 2 & 3
        if source == 1:
            return INTERNAL
        if source == 2:
            return self._crystal()
        if source == 3 and self.read(CONTROL) & PLL_ON:
            pll = self.read(PLL)
            if not pll >> 24 & 1:
                raise Stuck("the PLL's output R is off and is the processor's clock")
            before = {2: INTERNAL, 3: self._crystal()}[pll & 3]
            multiplied = before * (pll >> 8 & 0x7F) // ((pll >> 4 & 0xF) + 1)
            return multiplied // (2 * ((pll >> 25 & 3) + 1))
        raise Stuck(f"RCC has no clock {source}")

    def processor(self):
        """HCLK in Hz."""
        divider = self.read(CONFIGURATION) >> 4 & 0xF
        return self.source() >> max(0, divider - 7)

    def timer(self):
        """The clock of TIM15 in Hz: twice that of its bus, where that is divided."""
        divider = self.read(CONFIGURATION) >> 11 & 7
        return self.processor() >> max(0, divider - 4)

    def can(self):
        """The clock of the FDCANs in Hz."""
        source = self.read(PERIPHERAL_CLOCKS) >> 24 & 3
        if source == 0:
            return self._crystal()
        raise Stuck(f"the FDCANs are clocked from {source}")

    def _crystal(self):
        if not self.read(CONTROL) & CRYSTAL_ON:
            raise Stuck("the crystal is used and off")
        return CRYSTAL

    def excess(self):
        """What is faster than the core's voltage and the flash's wait states allow, or an empty text."""
        # Range 1.
        boost = not self.power.read(0x80) >> 8 & 1
        most, step = (170_000_000, 34_000_000) if boost else (150_000_000, 30_000_000)
        latency = self.flash.read(0) & 0xF
        if self.source() <= most and self.processor() <= step * (latency + 1):
            return ""
        clocks = f"SYSCLK has {self.source()} Hz and HCLK {self.processor()} Hz"
        return f"{clocks} with boost {boost} and {latency} wait states of the flash"
