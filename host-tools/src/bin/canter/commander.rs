//! What every verb does that moves axes: hold them, enable them where that is asked for, give them
//! back.

use crate::context::{AnyClient, Context, tell_complaints};
use anyhow::Result;
use canter::client::ClientError;
use canter::robot::Robot;
use canter_shared::axis::state::State;
use canter_shared::wire::id::AxisId;
use std::borrow::Cow;

/// A client, once each of these axes is there once and has been heard.
pub fn client(context: &Context, axes: &[AxisId]) -> Result<AnyClient> {
    let mut client = context.client()?;
    client.check(axes)?;
    client.listen()?;
    Ok(client)
}

/// Holds axes while something is done with them, and gives them back whatever came of it.
pub fn while_held<T>(
    client: &mut AnyClient,
    axes: &[AxisId],
    act: impl FnOnce(&mut AnyClient) -> Result<T>,
) -> Result<T> {
    client.hold(axes)?;
    let done = act(client);
    let released = client.release();
    tell_complaints(client);
    let done = done?;
    released?;
    Ok(done)
}

/// Enables those axes that are not, where that is asked for or the robot is simulated: that one is
/// fresh, and so disabled, at each command.
pub fn enable(
    context: &Context,
    client: &mut AnyClient,
    axes: &[AxisId],
    asked: bool,
) -> Result<(), ClientError> {
    if !asked && !context.is_simulated() {
        return Ok(());
    }
    let state = |axis: &AxisId| client.axes().get(axis).and_then(|known| known.state);
    let is_disabled = |axis: &&AxisId| state(axis) != Some(State::OperationEnabled);
    let disabled: Vec<AxisId> = axes.iter().filter(is_disabled).copied().collect();
    if disabled.is_empty() {
        return Ok(());
    }
    client.enable(&disabled)
}

/// The robot with the limits that count: what the nodes keep to, unless a robot file says what is
/// wanted.
pub fn robot<'a>(
    context: &'a Context,
    client: &mut AnyClient,
    axes: &[AxisId],
) -> Result<Cow<'a, Robot>, ClientError> {
    Ok(match context.robot_is_named {
        true => Cow::Borrowed(&context.robot),
        false => Cow::Owned(client.read_robot(axes)?),
    })
}
