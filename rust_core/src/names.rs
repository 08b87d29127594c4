//! Enums whose values have names in tables: each value is written once, with its name.

/// Makes an enum of values with their names; `ALL` has them in the order of their codes.
macro_rules! named {
    ($(#[$about:meta])* pub enum $Enum:ident {
        $($(#[$meaning:meta])* $Value:ident = $name:literal,)*
    }) => {
        $(#[$about])*
        pub enum $Enum {
            $($(#[$meaning])* $Value,)*
        }

        impl $Enum {
            /// All of them, in the order of their codes.
            pub const ALL: [Self; [$($name),*].len()] = [$(Self::$Value),*];

            /// The name in tables.
            pub fn name(self) -> &'static str {
                match self {
                    $(Self::$Value => $name,)*
                }
            }
        }
    };
}

pub(crate) use named;
