//! Reading characters: documents in order, documents with one fault each, and damage of every kind.
#![expect(clippy::unwrap_used, clippy::print_stderr, reason = "tests, and what they skip is printed")]

mod bad;
mod builder;
mod damage;
mod good;
