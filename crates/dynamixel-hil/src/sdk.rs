//! ROBOTIS's `dynamixel_sdk` for Python, one call at a time. The interpreter's lock is held for the length of a call and no longer.

use std::env;
use std::path::PathBuf;

use pyo3::exceptions::{PyAttributeError, PyIndexError, PyKeyError, PyTypeError, PyValueError};
use pyo3::prelude::*;
use pyo3::types::PyList;

use crate::register::{Register, value};

/// Folder with `dynamixel_sdk` and `serial`, where it is not that of the checkout.
const SDK_VARIABLE: &str = "DYNAMIXEL_SDK";
/// The Python environment of the set-up, whose packages an embedded interpreter does not find by itself.
const ENVIRONMENT_OF_THE_CHECKOUT: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../../.deps/venv");

/// Result codes of the SDK (`robotis_def.py`).
const COMM_SUCCESS: i32 = 0;
const COMM_RX_TIMEOUT: i32 = -3001;

/// Why a call brought nothing.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) enum Miss {
    /// No byte came in time.
    Timeout,
    /// Bytes came, but no whole packet.
    Corrupt,
    /// The port is gone, as the system says.
    Port(String),
}

type Answer<T> = Result<T, Miss>;

/// An open port and the SDK's packet handler.
pub(crate) struct Sdk {
    port: Py<PyAny>,
    packets: Py<PyAny>,
    module: Py<PyModule>,
}

/// A GroupSyncRead for some servos, made once.
pub(crate) struct SyncRead {
    group: Py<PyAny>,
    ids: Vec<u8>,
    /// All answers in one packet, where every servo can.
    pub(crate) fast: bool,
}

/// A GroupSyncWrite for some servos, made once.
pub(crate) struct SyncWrite {
    group: Py<PyAny>,
    ids: Vec<u8>,
    register: Register,
}

/// The SDK's module.
pub(crate) fn load() -> Result<Py<PyModule>, String> {
    Python::attach(|py| {
        let path = py.import("sys")?.getattr("path")?;
        let folder = env::var_os(SDK_VARIABLE).map_or_else(|| packages_of_the_checkout(py), PathBuf::from);
        // Python skips what is no text there.
        let folder = folder.to_string_lossy().into_owned();
        if !path.contains(&folder)? {
            path.call_method1("insert", (0, folder))?;
        }
        Ok(py.import("dynamixel_sdk")?.unbind())
    })
    .map_err(|error: PyErr| error.to_string())
}

fn packages_of_the_checkout(py: Python<'_>) -> PathBuf {
    let version = py.version_info();
    let python = format!("python{}.{}", version.major, version.minor);
    PathBuf::from(ENVIRONMENT_OF_THE_CHECKOUT).join("lib").join(python).join("site-packages")
}

impl Sdk {
    /// Opens a port. `latency_ms` is how long its adapter may keep bytes to itself; the SDK waits twice as long for an answer, and 2 ms.
    pub(crate) fn open(module: Py<PyModule>, name: &str, baud: u32, latency_ms: f64) -> Result<Self, String> {
        Python::attach(|py| {
            let sdk = module.bind(py);
            sdk.getattr("port_handler")?.setattr("LATENCY_TIMER", latency_ms)?;
            let port = sdk.call_method1("PortHandler", (name,))?;
            let packets = sdk.call_method1("PacketHandler", (2.0,))?.unbind();
            // Opens it, too.
            if !port.call_method1("setBaudRate", (baud,))?.extract::<bool>()? {
                return Ok(Err(format!("the SDK does not know {baud} baud")));
            }
            // Two masters would drive the arm to and fro between what they want.
            port.getattr("ser")?.setattr("exclusive", true)?;
            let port = port.unbind();
            Ok(Ok(Self { port, packets, module: module.clone_ref(py) }))
        })
        .unwrap_or_else(|error: PyErr| Err(error.to_string()))
    }

    /// The model number.
    pub(crate) fn ping(&self, id: u8) -> Answer<u16> {
        let (model, result, _): (u16, i32, u8) =
            self.call(|py| self.packets.bind(py).call_method1("ping", (&self.port, id))?.extract())?;
        checked(result).map(|()| model)
    }

    /// All servos that answer a broadcast ping.
    pub(crate) fn broadcast_ping(&self) -> Answer<Vec<u8>> {
        self.call(|py| {
            let answer = self.packets.bind(py).call_method1("broadcastPing", (&self.port,))?;
            let mut ids: Vec<u8> = answer
                .get_item(0)?
                .call_method0("keys")?
                .try_iter()?
                .map(|id| id?.extract())
                .collect::<PyResult<_>>()?;
            ids.sort_unstable();
            Ok(ids)
        })
    }

    /// Value and error byte.
    pub(crate) fn read(&self, id: u8, register: Register) -> Answer<(u32, u8)> {
        let arguments = (&self.port, id, register.address, register.size);
        let (data, result, error): (Vec<u8>, i32, u8) =
            self.call(|py| self.packets.bind(py).call_method1("readTxRx", arguments)?.extract())?;
        checked(result)?;
        // A belated answer to something else.
        if data.len() == usize::from(register.size) { Ok((value(&data), error)) } else { Err(Miss::Corrupt) }
    }

    /// The error byte.
    pub(crate) fn write(&self, id: u8, register: Register, value: u32) -> Answer<u8> {
        self.write_bytes(id, register.address, &register.bytes(value))
    }

    /// The error byte.
    pub(crate) fn write_bytes(&self, id: u8, address: u16, bytes: &[u8]) -> Answer<u8> {
        let (result, error): (i32, u8) = self.call(|py| {
            let data = PyList::new(py, bytes)?;
            let arguments = (&self.port, id, address, bytes.len(), data);
            self.packets.bind(py).call_method1("writeTxRx", arguments)?.extract()
        })?;
        checked(result).map(|()| error)
    }

    /// The error byte.
    pub(crate) fn reboot(&self, id: u8) -> Answer<u8> {
        let (result, error): (i32, u8) =
            self.call(|py| self.packets.bind(py).call_method1("reboot", (&self.port, id))?.extract())?;
        checked(result).map(|()| error)
    }

    /// A group that reads `length` bytes from `address` on of each servo.
    pub(crate) fn sync_read_group(&self, ids: &[u8], address: u16, length: u16, fast: bool) -> Answer<SyncRead> {
        self.call(|py| {
            let arguments = (&self.port, &self.packets, address, length);
            let group = self.module.bind(py).call_method1("GroupSyncRead", arguments)?;
            ids.iter().try_for_each(|id| group.call_method1("addParam", (*id,)).map(drop))?;
            Ok(SyncRead { group: group.unbind(), ids: ids.to_vec(), fast })
        })
    }

    /// The bytes of each servo, in the order of the group.
    pub(crate) fn sync_read(&self, read: &SyncRead) -> Answer<Vec<Vec<u8>>> {
        let method = if read.fast { "fastSyncRead" } else { "txRxPacket" };
        self.call(|py| {
            let group = read.group.bind(py);
            match checked(group.call_method0(method)?.extract()?) {
                Err(miss) => Ok(Err(miss)),
                Ok(()) => {
                    let data = group.getattr("data_dict")?;
                    read.ids.iter().map(|id| data.get_item(*id)?.extract()).collect::<PyResult<_>>().map(Ok)
                }
            }
        })?
    }

    /// A group that writes a register of each servo.
    pub(crate) fn sync_write_group(&self, ids: &[u8], register: Register) -> Answer<SyncWrite> {
        self.call(|py| {
            let arguments = (&self.port, &self.packets, register.address, register.size);
            let group = self.module.bind(py).call_method1("GroupSyncWrite", arguments)?;
            let zeros = register.bytes(0);
            ids.iter().try_for_each(|id| group.call_method1("addParam", (*id, PyList::new(py, &zeros)?)).map(drop))?;
            Ok(SyncWrite { group: group.unbind(), ids: ids.to_vec(), register })
        })
    }

    /// Writes a value to each servo, in the order of the group. Nobody answers.
    pub(crate) fn sync_write(&self, write: &SyncWrite, values: &[u32]) -> Answer<()> {
        let result = self.call(|py| {
            let group = write.group.bind(py);
            for (id, value) in write.ids.iter().zip(values) {
                group.call_method1("changeParam", (*id, PyList::new(py, write.register.bytes(*value))?))?;
            }
            group.call_method0("txPacket")?.extract()
        })?;
        checked(result)
    }

    /// One register of each servo, whichever they are, in one exchange.
    pub(crate) fn bulk_read(&self, wanted: &[(u8, Register)]) -> Answer<Vec<u32>> {
        self.call(|py| {
            let group = self.module.bind(py).call_method1("GroupBulkRead", (&self.port, &self.packets))?;
            for (id, register) in wanted {
                group.call_method1("addParam", (*id, register.address, register.size))?;
            }
            if let Err(miss) = checked(group.call_method0("txRxPacket")?.extract()?) {
                return Ok(Err(miss));
            }
            let get = |(id, register): &(u8, Register)| {
                group.call_method1("getData", (*id, register.address, register.size))?.extract()
            };
            wanted.iter().map(get).collect::<PyResult<_>>().map(Ok)
        })?
    }

    /// Writes one register of each servo, whichever they are, in one packet. Nobody answers.
    pub(crate) fn bulk_write(&self, values: &[(u8, Register, u32)]) -> Answer<()> {
        let result = self.call(|py| {
            let group = self.module.bind(py).call_method1("GroupBulkWrite", (&self.port, &self.packets))?;
            for (id, register, value) in values {
                let data = PyList::new(py, register.bytes(*value))?;
                group.call_method1("addParam", (*id, register.address, register.size, data))?;
            }
            group.call_method0("txPacket")?.extract()
        })?;
        checked(result)
    }

    /// Runs some Python, and sorts what it raises.
    fn call<T>(&self, run: impl FnOnce(Python<'_>) -> PyResult<T>) -> Answer<T> {
        Python::attach(|py| {
            run(py).map_err(|error| {
                // The SDK does not do this when it is interrupted, and would say for ever that the port is busy.
                let _ = self.port.bind(py).setattr("is_using", false);
                // What it trips over are packets that are shorter than they say.
                let tripped = error.is_instance_of::<PyIndexError>(py)
                    || error.is_instance_of::<PyKeyError>(py)
                    || error.is_instance_of::<PyValueError>(py)
                    || error.is_instance_of::<PyTypeError>(py);
                if tripped { Miss::Corrupt } else { Miss::Port(reason(py, &error)) }
            })
        })
    }
}

impl Sdk {
    /// Closes the port: what is asked from now on finds none. Nothing can be done about a port that does not close.
    pub(crate) fn close(&self) {
        let _ = self.call(|py| self.port.bind(py).call_method0("closePort").map(drop));
    }
}

impl Drop for Sdk {
    fn drop(&mut self) {
        self.close();
    }
}

/// What an exception says, on one line; closed ports of pyserial show as attributes of nothing.
fn reason(py: Python<'_>, error: &PyErr) -> String {
    if error.is_instance_of::<PyAttributeError>(py) {
        return "it was never opened".into();
    }
    error.value(py).to_string().split_whitespace().collect::<Vec<_>>().join(" ")
}

fn checked(result: i32) -> Answer<()> {
    match result {
        COMM_SUCCESS => Ok(()),
        COMM_RX_TIMEOUT => Err(Miss::Timeout),
        _ => Err(Miss::Corrupt),
    }
}
