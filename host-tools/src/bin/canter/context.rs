//! What every verb needs: the bus, the robot, and where its output goes.

use crate::arguments::{Arguments, BusAddress};
use anyhow::{Context as _, Result};
use canter::bus::{Address, Bitrate, Bus};
use canter::client::Client;
use canter::notation::AxisList;
use canter::profile::table::parse_times;
use canter::robot::Robot;
use canter::sim::{Configuration, SimulatedBus};
use canter_shared::wire::id::AxisId;
use std::collections::hash_map::RandomState;
use std::hash::{BuildHasher, Hasher};
use std::io::{Read, Write};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

/// A client on whatever bus was chosen.
pub type AnyClient = Client<Box<dyn Bus>>;

/// The bus, the robot, the output.
pub struct Context {
    pub address: Address,
    pub robot: Robot,
    /// Whether the robot is from a file, and not the one that is assumed.
    pub robot_is_named: bool,
    pub json: bool,
}

impl Context {
    pub fn new(arguments: &Arguments) -> Result<Self> {
        let robot = match &arguments.robot {
            Some(path) => Robot::read(path)?,
            None => Robot::default(),
        };
        let named = arguments.can.clone().map(|BusAddress(address)| address);
        Ok(Self {
            address: named.unwrap_or(Address::Simulated),
            robot,
            robot_is_named: arguments.robot.is_some(),
            json: arguments.json,
        })
    }

    /// Whether the bus is the simulated robot, which is fresh and disabled at each command.
    pub fn is_simulated(&self) -> bool {
        matches!(self.address, Address::Simulated)
    }

    /// The bus's bit rate as far as it is known: that of the adapter, otherwise the usual one.
    pub fn bitrate(&self) -> Bitrate {
        match self.address {
            Address::Slcan { bitrate, .. } => bitrate,
            _ => Bitrate::default(),
        }
    }

    /// Opens the bus; where it is the simulated one, says so, and gives it a bit rate.
    pub fn open(&self, bitrate: Bitrate) -> Result<Box<dyn Bus>> {
        if self.is_simulated() {
            let axes = self.robot.axes().len();
            eprintln!("bus: sim, a simulated robot of {axes} axes; choose another with --can");
            return Ok(Box::new(SimulatedBus::new(&Configuration {
                bitrate,
                ..Configuration::of(&self.robot)
            })));
        }
        Ok(self.address.open()?)
    }

    /// A client on the bus, which ends what it does on an interrupt or a termination signal.
    pub fn client(&self) -> Result<AnyClient> {
        let client = self.deaf_client(self.bitrate())?;
        on_signal(client.interrupt())?;
        Ok(client)
    }

    /// A client on the bus that hears no signals.
    pub fn deaf_client(&self, bitrate: Bitrate) -> Result<AnyClient> {
        Ok(Client::new(self.open(bitrate)?, random_session()))
    }

    /// Prints a JSON document on stdout where that was asked for.
    pub fn print_json(&self, document: &serde_json::Value) {
        if self.json {
            println!("{document}");
        }
    }
}

/// Prints lines of data on stdout. A reader that has seen enough, such as `head`, is no error.
pub fn print_all(lines: impl Iterator<Item = String>) -> Result<()> {
    let mut out = std::io::BufWriter::new(std::io::stdout().lock());
    let written = (|| {
        for line in lines {
            writeln!(out, "{line}")?;
        }
        out.flush()
    })();
    match written {
        Err(error) if error.kind() != std::io::ErrorKind::BrokenPipe => {
            Err(error).context("cannot write to stdout")
        }
        _ => Ok(()),
    }
}

/// The times that `--at` names: one on each line of a file, or of stdin for `-`.
pub fn read_times(name: &str) -> Result<Vec<f64>> {
    let mut text = String::new();
    if name == "-" {
        std::io::stdin()
            .read_to_string(&mut text)
            .context("--at -: stdin cannot be read")?;
    } else {
        text = std::fs::read_to_string(name).with_context(|| format!("--at {name}"))?;
    }
    parse_times(&text).with_context(|| format!("--at {name}"))
}

/// A session that no other host is likely to have drawn.
fn random_session() -> u16 {
    RandomState::new().build_hasher().finish() as u16
}

/// Sets `flag` on SIGINT, SIGTERM and SIGHUP.
pub fn on_signal(flag: Arc<AtomicBool>) -> Result<()> {
    on_signal_do(move || flag.store(true, Ordering::Relaxed))
}

/// Does something on each of these signals, beside the program.
pub fn on_signal_do(act: impl FnMut() + Send + 'static) -> Result<()> {
    ctrlc::set_handler(act).context("cannot install the signal handler")
}

/// The axes that a list means: all those that are heard on the bus, or these.
pub fn resolve(client: &mut AnyClient, list: &AxisList) -> Result<Vec<AxisId>> {
    let heard = client.listen()?;
    match list {
        AxisList::These(axes) => Ok(axes.clone()),
        AxisList::All if heard.is_empty() => {
            let bus = client.bus().description();
            Err(canter::client::ClientError::NobodyThere { bus }.into())
        }
        AxisList::All => Ok(heard),
    }
}

/// Tells what the bus complained of, on stderr.
pub fn tell_complaints(client: &mut AnyClient) {
    for words in client.take_complaints() {
        eprintln!("bus: {words}");
    }
}
