//! The board's LED: it shows that the control loop lives.

use canter_shared::axis::state::State;
use canter_shared::node::AxisSetpoint;
use embassy_stm32::gpio::Output;

use crate::port::SetpointSink;

/// Half of a second's blink, in ticks.
const HALF_PERIOD: u32 = 500;

/// While an axis has a fault: five in a second.
const HALF_PERIOD_IN_FAULT: u32 = 100;

/// One blink in a second, five while an axis has a fault.
///
/// It is told all setpoints, and looks at the states only: the drives have a bus of their own.
pub struct Led {
    pin: Output<'static>,
    ticks: u32,
}

impl Led {
    /// Dark until the first tick.
    pub fn new(pin: Output<'static>) -> Self {
        Self { pin, ticks: 0 }
    }
}

impl SetpointSink for Led {
    fn put(&mut self, setpoints: &[AxisSetpoint]) {
        let fault = setpoints.iter().any(|axis| axis.state == State::Fault);
        let half_period = if fault {
            HALF_PERIOD_IN_FAULT
        } else {
            HALF_PERIOD
        };
        self.ticks += 1;
        if self.ticks >= half_period {
            self.ticks = 0;
            self.pin.toggle();
        }
    }
}
