//! Adapters: the GPUs of this machine, as reported by its drivers, and the choice of one.

use wgpu::{Backends, DeviceType, Instance, InstanceDescriptor, InstanceFlags};

use crate::failure::{Failure, GpuResult};

/// A GPU as reported by its driver.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Adapter {
    /// Name, as reported by the driver.
    pub name: String,
    /// Vulkan, Metal or DX12.
    pub backend: &'static str,
    /// Discrete, integrated, virtual, software, or other.
    pub kind: &'static str,
    /// Name and version of the driver.
    pub driver: String,
    /// PCI ids of vendor and device.
    pub ids: [u32; 2],
}

impl Adapter {
    fn of(adapter: &wgpu::Adapter) -> Self {
        let info = adapter.get_info();
        let kind = match info.device_type {
            DeviceType::DiscreteGpu => "discrete",
            DeviceType::IntegratedGpu => "integrated",
            DeviceType::VirtualGpu => "virtual",
            DeviceType::Cpu => "software",
            DeviceType::Other => "other",
        };
        let backend = match info.backend {
            wgpu::Backend::Vulkan => "Vulkan",
            wgpu::Backend::Metal => "Metal",
            wgpu::Backend::Dx12 => "DX12",
            wgpu::Backend::Gl => "OpenGL",
            wgpu::Backend::BrowserWebGpu => "WebGPU",
            wgpu::Backend::Noop => "none",
        };
        let driver = [info.driver, info.driver_info].join(" ").trim().to_owned();
        Self { name: info.name, backend, kind, driver, ids: [info.vendor, info.device] }
    }

    /// Whether the adapter is a software renderer on the CPU, which is never chosen automatically.
    pub fn is_software(&self) -> bool {
        self.kind == "software"
    }

    /// Whether the adapter is a GPU with memory of its own.
    pub fn is_discrete(&self) -> bool {
        self.kind == "discrete"
    }

    /// Sort key: lower is preferred.
    fn rank(&self) -> usize {
        let of_kind = ["discrete", "integrated", "virtual", "other"].iter().position(|kind| *kind == self.kind);
        // The same card may be there twice; compilers of DX12 are slow.
        2 * of_kind.unwrap_or(4) + usize::from(self.backend == "DX12")
    }
}

/// Choice of a GPU.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub enum Choice {
    /// The best GPU that is not a software renderer.
    Best,
    /// The GPU of this name; else the first whose "name backend" contains this text, ignoring case. Software renderers
    /// included.
    Named(String),
}

/// All GPUs of this machine, the best first.
pub fn adapters() -> Vec<Adapter> {
    all().1.into_iter().map(|(adapter, _)| adapter).collect()
}

fn all() -> (Instance, Vec<(Adapter, wgpu::Adapter)>) {
    let backends = Backends::VULKAN | Backends::METAL | Backends::DX12;
    // A refusal is better than memory that the system pages out.
    let memory_budget_thresholds =
        wgpu::MemoryBudgetThresholds { for_resource_creation: Some(80), for_device_loss: None };
    let instance = Instance::new(InstanceDescriptor {
        backends,
        flags: InstanceFlags::empty(),
        memory_budget_thresholds,
        ..InstanceDescriptor::new_without_display_handle()
    });
    let found = pollster::block_on(instance.enumerate_adapters(backends));
    let mut adapters: Vec<_> = found.into_iter().map(|adapter| (Adapter::of(&adapter), adapter)).collect();
    adapters.sort_by_key(|(adapter, _)| adapter.rank());
    (instance, adapters)
}

/// Chooses an adapter among all of this machine.
pub(crate) fn choose(choice: &Choice) -> GpuResult<(Instance, Adapter, wgpu::Adapter)> {
    let (instance, adapters) = all();
    let names: Vec<String> = adapters.iter().map(|(adapter, _)| format!("{:?}", adapter.name)).collect();
    let is_wanted = |adapter: &Adapter| match choice {
        Choice::Best => !adapter.is_software(),
        Choice::Named(part) => {
            format!("{} {}", adapter.name, adapter.backend).to_lowercase().contains(&part.to_lowercase())
        }
    };
    let there_are =
        if names.is_empty() { "there is none".to_owned() } else { format!("there are {}", names.join(", ")) };
    // An exact name takes precedence over a substring.
    let is_whole = |adapter: &Adapter| match choice {
        Choice::Best => false,
        Choice::Named(name) => *name == adapter.name || *name == format!("{} {}", adapter.name, adapter.backend),
    };
    let place = adapters.iter().position(|(adapter, _)| is_whole(adapter));
    let place = place.or_else(|| adapters.iter().position(|(adapter, _)| is_wanted(adapter)));
    match place.and_then(|place| adapters.into_iter().nth(place)) {
        Some((facts, adapter)) => Ok((instance, facts, adapter)),
        None => Err(Failure::NoAdapter(match choice {
            Choice::Best => format!("no GPU was found: {there_are}"),
            Choice::Named(part) => format!("no GPU has {part:?} in its name: {there_are}"),
        })),
    }
}

/// The adapter that a choice stands for, without opening it.
pub(crate) fn resolved(choice: &Choice) -> GpuResult<Adapter> {
    choose(choice).map(|(_, adapter, _)| adapter)
}
