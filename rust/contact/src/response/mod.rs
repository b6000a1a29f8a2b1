//! Stage 3: the response of the skin to forces.

pub mod assembly;
pub mod bonded_layer;
pub mod entries;
pub mod kernel_grid;
pub mod kernel_tables;
pub mod near_field;
pub mod quantized_rows;
pub mod stiff_skin_kernel;
pub mod rows;
pub mod tissue_geometry;
pub mod plate_on_layer;

#[cfg(test)]
pub(crate) mod test_sheet;
