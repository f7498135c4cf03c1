//! An open device: the adapter's limits, error scopes, and the loss of the device.

use std::sync::{Arc, Mutex};

use wavesplat_compute::locks::lock;
use wgpu::{DeviceDescriptor, ErrorFilter, Features, Limits, PollType};

use crate::adapter::{Adapter, Choice, choose};
use crate::failure::{Failure, GpuResult};

/// A device and its queue.
pub(crate) struct OpenDevice {
    pub device: wgpu::Device,
    pub queue: wgpu::Queue,
    pub adapter: Adapter,
    pub limits: Limits,
    /// Whether passes can be timed.
    pub has_timestamps: bool,
    /// Reason of the loss, once the device is lost.
    lost: Arc<Mutex<Option<String>>>,
    /// Kept as long as the device.
    _instance: wgpu::Instance,
}

impl OpenDevice {
    pub fn open(choice: &Choice) -> GpuResult<Self> {
        let (instance, facts, adapter) = choose(choice)?;
        let limits = adapter.limits();
        let optional = Features::TIMESTAMP_QUERY;
        let descriptor = DeviceDescriptor {
            label: Some("wavesplat"),
            required_features: adapter.features() & optional,
            required_limits: limits.clone(),
            ..DeviceDescriptor::default()
        };
        let opened = pollster::block_on(adapter.request_device(&descriptor));
        let (device, queue) =
            opened.map_err(|error| Failure::Refused(format!("{} cannot be opened: {error}", facts.name)))?;
        let lost = Arc::new(Mutex::new(None));
        let (by_loss, by_error) = (lost.clone(), lost.clone());
        let note = |lost: &Mutex<Option<String>>, why: String| {
            lock(lost).get_or_insert(why);
        };
        device.set_device_lost_callback(move |reason, message| note(&by_loss, format!("{reason:?} {message}")));
        // An error outside all scopes marks the device as lost; by default it would end the program.
        device.on_uncaptured_error(Arc::new(move |error| note(&by_error, error.to_string())));
        let has_timestamps = device.features().contains(optional);
        Ok(Self { device, queue, adapter: facts, limits, has_timestamps, lost, _instance: instance })
    }

    /// Reason of the loss, if the device is lost.
    pub fn lost(&self) -> Option<String> {
        lock(&self.lost).clone()
    }

    /// Runs work within error scopes; an error of the device becomes a [`Failure`].
    pub fn guarded<T>(&self, work: impl FnOnce() -> GpuResult<T>) -> GpuResult<T> {
        let filters = [ErrorFilter::Internal, ErrorFilter::Validation, ErrorFilter::OutOfMemory];
        let scopes = filters.map(|filter| self.device.push_error_scope(filter));
        let done = work();
        let mut failure = None;
        for scope in scopes.into_iter().rev() {
            if let Some(error) = pollster::block_on(scope.pop()) {
                failure = failure.or(Some(match error {
                    wgpu::Error::OutOfMemory { .. } => {
                        Failure::Allocation("the GPU has too little memory left".to_owned())
                    }
                    other => Failure::Refused(other.to_string()),
                }));
            }
        }
        match (self.lost(), failure) {
            (Some(why), _) => Err(Failure::Lost(why)),
            (None, Some(failure)) => Err(failure),
            (None, None) => done,
        }
    }

    /// Waits until all submitted work is done.
    pub fn wait(&self) -> GpuResult<()> {
        let waited = self.device.poll(PollType::wait_indefinitely());
        match (self.lost(), waited) {
            (Some(why), _) => Err(Failure::Lost(why)),
            (None, Err(error)) => Err(Failure::Lost(error.to_string())),
            (None, Ok(_)) => Ok(()),
        }
    }
}
