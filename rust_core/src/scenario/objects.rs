//! Macros that make structs and enums of a scenario, together with their readers from JSON, from one table each.
//!
//! In the tables, `= method(rule)` after a field is the method of [`Fields`] that reads it.

use super::fields::{Checked, Fields, one_of};

/// A value that is read from a JSON object.
pub(super) trait FromJson: Sized {
    /// Reads its fields; the caller checks that there are no others.
    fn read(f: &mut Fields) -> Checked<Self>;
}

/// One of a fixed set of names.
pub(super) trait Choice: Copy + 'static {
    /// All values by name.
    const ALL: &'static [(&'static str, Self)];
}

/// Makes a struct, and reads it; a method can check its fields together.
macro_rules! object {
    (
        $(#[$about:meta])*
        pub struct $name:ident {
            $($(#[$note:meta])* $field:ident: $kind:ty = $method:ident($($rule:expr),*),)*
        }
        $(then $check:ident)?
    ) => {
        $(#[$about])*
        #[derive(Clone, Debug, PartialEq, Serialize)]
        pub struct $name {
            $($(#[$note])* pub $field: $kind,)*
        }

        impl FromJson for $name {
            fn read(f: &mut Fields) -> Checked<Self> {
                let object = Self {
                    $($field: f.$method(stringify!($field), $($rule),*)?,)*
                };
                $(object.$check(f)?;)?
                Ok(object)
            }
        }
    };
}

/// Makes an enum of several kinds of objects, and reads the one named by "kind".
macro_rules! kinds {
    (
        $(#[$about:meta])*
        pub enum $name:ident {
            $(
                $(#[$note:meta])*
                $text:literal $variant:ident
                $({ $($(#[$of:meta])* $field:ident: $kind:ty = $method:ident($($rule:expr),*),)* })?
                $(($inner:ty))?,
            )*
        }
    ) => {
        $(#[$about])*
        #[derive(Clone, Debug, PartialEq, Serialize)]
        #[serde(tag = "kind")]
        pub enum $name {
            $(
                $(#[$note])*
                #[serde(rename = $text)]
                $variant $({ $($(#[$of])* $field: $kind,)* })? $(($inner))?,
            )*
        }

        impl FromJson for $name {
            fn read(f: &mut Fields) -> Checked<Self> {
                match f.text("kind")? {
                    $($text => Ok(Self::$variant
                        $({ $($field: f.$method(stringify!($field), $($rule),*)?,)* })?
                        $((<$inner>::read(f)?))?
                    ),)*
                    other => Err(f.error("kind", other, one_of(Some(other), &[$($text),*]))),
                }
            }
        }
    };
}

/// Makes an enum of names.
macro_rules! choice {
    (
        $(#[$about:meta])*
        pub enum $name:ident {
            $($(#[$note:meta])* $text:literal $variant:ident,)*
        }
    ) => {
        $(#[$about])*
        #[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
        pub enum $name {
            $($(#[$note])* #[serde(rename = $text)] $variant,)*
        }

        impl Choice for $name {
            const ALL: &'static [(&'static str, Self)] = &[$(($text, Self::$variant)),*];
        }
    };
}

pub(super) use {choice, kinds, object};

impl Fields<'_> {
    /// Reads an object and nothing else.
    pub(super) fn object<T: FromJson>(&mut self, name: &'static str) -> Checked<T> {
        let mut inner = self.child(name)?;
        let object = T::read(&mut inner)?;
        inner.finish()?;
        Ok(object)
    }

    /// The same, or null.
    pub(super) fn optional_object<T: FromJson>(
        &mut self,
        name: &'static str,
    ) -> Checked<Option<T>> {
        self.unless_null(name, Self::object)
    }

    /// Reads a struct whose fields are among those of this object.
    pub(super) fn flat<T: FromJson>(&mut self, _: &str) -> Checked<T> {
        T::read(self)
    }

    /// Reads one of a fixed set of names.
    pub(super) fn choice<T: Choice>(&mut self, name: &'static str) -> Checked<T> {
        let value = self.value(name)?;
        let mut all = T::ALL.iter();
        let found = all.find(|(choice, _)| value.as_str() == Some(choice));
        found.map(|(_, choice)| *choice).ok_or_else(|| {
            let names: Vec<&str> = T::ALL.iter().map(|(name, _)| *name).collect();
            self.error(name, value, one_of(value.as_str(), &names))
        })
    }
}
