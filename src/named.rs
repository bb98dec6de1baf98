//! Enums whose values have names.

/// Defines an enum with a constant `ALL` and, after `fn name;`, a method that returns the name written
/// beside each value.
macro_rules! named {
    (
        $(fn $method:ident;)?
        $(#[$meta:meta])* pub enum $Enum:ident { $($(#[$inner:meta])* $Value:ident $(= $name:literal)?,)* }
    ) => {
        $(#[$meta])*
        pub enum $Enum { $($(#[$inner])* $Value,)* }

        impl $Enum {
            /// All values, in their order.
            pub const ALL: [Self; [$(stringify!($Value)),*].len()] = [$(Self::$Value),*];
        }

        named!(@ $($method)?, $Enum { $($Value $(= $name)?,)* });
    };
    (@, $Enum:ident $values:tt) => {};
    (@ $method:ident, $Enum:ident { $($Value:ident = $name:literal,)* }) => {
        impl $Enum {
            /// Returns the name, for display, files and the command line.
            pub fn $method(self) -> &'static str {
                match self { $(Self::$Value => $name,)* }
            }
        }
    };
}
