//! Files from and for other programs: exports of what the window shows, and imports of point pairs and geometries.

mod command;
mod exporting;
mod importing;
mod profile;
mod source;
mod view;

pub use command::ExchangeCommand;
pub use exporting::{Content, Order, Reported, What, content, picture};
pub use importing::{Found, Importing, Matrix, Pending, Question};
pub use profile::CONVENTION as PROFILE_CONVENTION;
pub use source::{Source, is_importable, sources};
pub use view::{Capturing, ViewPart};
