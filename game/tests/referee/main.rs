//! The referee, judged from outside: scenes with a few boats, and long random walks.

mod boundary;
mod collision;
mod end;
mod flag;
mod home;
mod mirror;
mod moment;
mod power_play;
mod preset;
mod scene;
mod several;
mod tag;
mod walk;
