//! The items of the control tables that the emulator itself reads or writes. The tables say the rest; a test compares the two.

/// An item of a control table: where it is, and how many bytes it has.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Item {
    /// Address of its least significant byte.
    pub address: u16,
    /// Number of its bytes: 1, 2 or 4.
    pub size: u16,
}

macro_rules! items {
    ($($name:ident = $address:literal, $size:literal;)*) => {
        $(#[allow(missing_docs)] pub const $name: Item = Item { address: $address, size: $size };)*
        /// All of them, with the names that the tables give them in capitals.
        pub const ALL: &[(&str, Item)] = &[$((stringify!($name), $name)),*];
    };
}

items! {
    MODEL_NUMBER = 0, 2;
    FIRMWARE_VERSION = 6, 1;
    ID = 7, 1;
    BAUD_RATE = 8, 1;
    RETURN_DELAY_TIME = 9, 1;
    DRIVE_MODE = 10, 1;
    OPERATING_MODE = 11, 1;
    SECONDARY_ID = 12, 1;
    HOMING_OFFSET = 20, 4;
    MOVING_THRESHOLD = 24, 4;
    TEMPERATURE_LIMIT = 31, 1;
    MAX_VOLTAGE_LIMIT = 32, 2;
    MIN_VOLTAGE_LIMIT = 34, 2;
    PWM_LIMIT = 36, 2;
    CURRENT_LIMIT = 38, 2;
    VELOCITY_LIMIT = 44, 4;
    MAX_POSITION_LIMIT = 48, 4;
    MIN_POSITION_LIMIT = 52, 4;
    STARTUP_CONFIGURATION = 60, 1;
    SHUTDOWN = 63, 1;
    TORQUE_ENABLE = 64, 1;
    LED = 65, 1;
    STATUS_RETURN_LEVEL = 68, 1;
    REGISTERED_INSTRUCTION = 69, 1;
    HARDWARE_ERROR_STATUS = 70, 1;
    VELOCITY_I_GAIN = 76, 2;
    VELOCITY_P_GAIN = 78, 2;
    POSITION_D_GAIN = 80, 2;
    POSITION_I_GAIN = 82, 2;
    POSITION_P_GAIN = 84, 2;
    FEEDFORWARD_2ND_GAIN = 88, 2;
    FEEDFORWARD_1ST_GAIN = 90, 2;
    BUS_WATCHDOG = 98, 1;
    GOAL_PWM = 100, 2;
    GOAL_CURRENT = 102, 2;
    GOAL_VELOCITY = 104, 4;
    PROFILE_ACCELERATION = 108, 4;
    PROFILE_VELOCITY = 112, 4;
    GOAL_POSITION = 116, 4;
    REALTIME_TICK = 120, 2;
    MOVING = 122, 1;
    MOVING_STATUS = 123, 1;
    PRESENT_PWM = 124, 2;
    PRESENT_CURRENT = 126, 2;
    PRESENT_LOAD = 126, 2;
    PRESENT_VELOCITY = 128, 4;
    PRESENT_POSITION = 132, 4;
    VELOCITY_TRAJECTORY = 136, 4;
    POSITION_TRAJECTORY = 140, 4;
    PRESENT_INPUT_VOLTAGE = 144, 2;
    PRESENT_TEMPERATURE = 146, 1;
    BACKUP_READY = 147, 1;
}
