//! The verbs, one file each.

mod compare;
mod demo;
mod drive;
mod foot;
mod gait;
mod leg;
mod log;
mod r#move;
mod node;
mod param;
mod path;
mod plan;
mod power;
mod scan;
mod soak;
mod status;
mod stop;
mod tools;
mod watch;
mod zero;

use crate::arguments::{Arguments, Verb};
use crate::context::Context;
use anyhow::Result;
use canter::profile::PlanError;

/// Runs the verb that was asked for.
pub fn run(arguments: Arguments) -> Result<()> {
    let context = Context::new(&arguments)?;
    match arguments.verb {
        Verb::Demo(demo) => demo::run(&context, &demo),
        Verb::Node(node) => node::run(&context, &node),
        Verb::Drive(drive) => drive::run(&context, &drive),
        Verb::Scan(arguments) => scan::run(&context, &arguments),
        Verb::Param(arguments) => param::run(&context, &arguments),
        Verb::Status => status::run(&context),
        Verb::Watch(wanted) => watch::run(&context, &wanted),
        Verb::Enable(list) => power::run(&context, power::Change::Enable, &list.axes),
        Verb::Disable(list) => power::run(&context, power::Change::Disable, &list.axes),
        Verb::Clear(list) => power::run(&context, power::Change::Clear, &list.axes),
        Verb::Stop(list) => stop::run(&context, &list.axes),
        Verb::Estop(list) => stop::emergency(&context, &list.axes),
        Verb::Zero(request) => zero::run(&context, &request),
        Verb::Move(request) => r#move::run(&context, &request),
        Verb::Plan(request) => plan::run(&context, &request),
        Verb::Path(request) => path::run(&context, &request),
        Verb::Compare(request) => compare::run(&context, &request),
        Verb::Foot(request) => foot::run(&context, &request),
        Verb::Gait(request) => gait::run(&context, &request.action),
        Verb::Leg(request) => leg::run(&context, &request.action),
        Verb::Log(request) => log::run(&context, &request.action),
        Verb::Soak(request) => soak::run(&context, &request),
        Verb::Dbc => tools::dbc(),
        Verb::Completions(wanted) => tools::completions(wanted.shell),
        Verb::Man => tools::man(),
    }
}

/// Whether an error says that the command line was wrong, rather than that something failed.
pub fn is_usage(error: &anyhow::Error) -> bool {
    let plan = error.downcast_ref::<PlanError>();
    plan.is_some_and(PlanError::is_usage)
        || param::is_usage(error)
        || leg::is_usage(error)
        || gait::is_usage(error)
}
