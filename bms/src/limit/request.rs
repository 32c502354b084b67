//! Who is heard.

/// What somebody asks for.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "recorder", derive(serde::Serialize, serde::Deserialize))]
pub enum Request {
    /// Nobody is there, or has not been heard in time.
    #[default]
    Silent,
    /// Open.
    Off,
    /// Close to drive.
    Drive,
    /// Close to charge.
    Charge,
    /// A value that has no meaning.
    Unknown,
}

/// What is done.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "recorder", derive(serde::Serialize, serde::Deserialize))]
pub enum Mode {
    /// Open.
    #[default]
    Off,
    /// Closed to drive.
    Drive,
    /// Closed to charge.
    Charge,
}

/// What is done of what vehicle and charger ask for: off before all, and off wherever they do not
/// agree or one is not understood. A charger alone may charge, and never drives.
#[must_use]
pub const fn arbitrate(vehicle: Request, charger: Request) -> Mode {
    match (vehicle, charger) {
        (Request::Drive, Request::Silent) => Mode::Drive,
        (Request::Charge | Request::Silent, Request::Charge)
        | (Request::Charge, Request::Silent) => Mode::Charge,
        _ => Mode::Off,
    }
}
