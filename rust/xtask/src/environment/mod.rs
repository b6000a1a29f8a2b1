//! Python environments, Blender modules, the wheel and the extension.

pub mod blenders;
pub mod extension;
pub mod manual;
pub mod python;
pub mod wheel;
