//! Reading characters: documents in order, documents with one fault each, and damage of every kind.

mod bad;
mod builder;
mod damage;
mod good;
