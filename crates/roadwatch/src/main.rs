//! `roadwatch`: reads every camera of a vehicle and publishes what is around it over ROS 2.

use std::process::ExitCode;

fn main() -> ExitCode {
    roadwatch::main_with(std::env::args_os())
}
