//! Sessions against a model of the page, its browser and the program, in which everything that takes time ends in any order.

mod awaited;
mod cases;
mod events;
mod history;
mod latest;
mod opening;
mod orders;
mod privacy;
mod program;
mod programs;
mod world;
