//! The window without a display: clicks, drags, keys and dropped files, as a person would make them.
#![cfg(feature = "inspector")]

mod album;
mod calibrated;
mod clipboard;
mod colmap;
mod computing;
mod editing;
mod exchange;
mod figures;
mod imports;
mod killed;
mod looking;
mod opening;
mod panels;
mod pins;
mod places;
mod planes;
mod points;
mod rectified;
mod repairing;
mod replay;
mod scene;
mod sequences;
mod sessions;
mod support;
mod terms;
mod truth;
mod unclicked;
