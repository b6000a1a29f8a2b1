//! The native Python module: exports, arrays, one error table. Knows no algorithm.

mod errors;
mod ending;
mod arrays;
mod readings;
mod record;
mod running;
mod material;
mod product;
mod effects;
mod protocol;
mod requests;
mod skin;
mod walk;
mod contact;
mod contact_records;
mod instrument;
mod hand;
mod references;
mod complementarity;
mod recordings;
mod study;
mod placing;
mod comparison;
mod prints;
mod diagnosis;
mod parquet_table;
mod about;

use pyo3::prelude::*;

/// Contact of soft skin with products: forces, pressures and shapes, in mm, N, MPa and s.
#[pymodule]
fn thenar(module: &Bound<'_, PyModule>) -> PyResult<()> {
    running::keep_panics_off_the_terminal();
    errors::register(module)?;
    ending::register(module)?;
    record::register(module)?;
    module.add_class::<material::Material>()?;
    module.add_class::<product::Product>()?;
    module.add_class::<effects::Effect>()?;
    module.add_class::<skin::elastomer::Elastomer>()?;
    module.add_class::<protocol::Course>()?;
    module.add_class::<skin::Skin>()?;
    module.add_class::<walk::Walk>()?;
    module.add_class::<instrument::Mat>()?;
    module.add_function(wrap_pyfunction!(instrument::observe, module)?)?;
    module.add_class::<contact::Contact>()?;
    module.add_class::<study::Study>()?;
    module.add_class::<comparison::Comparison>()?;
    module.add_class::<diagnosis::Diagnosis>()?;
    module.add_function(wrap_pyfunction!(diagnosis::diagnose, module)?)?;
    module.add_function(wrap_pyfunction!(hand::hand, module)?)?;
    module.add_function(wrap_pyfunction!(
        references::solid::reference_press,
        module
    )?)?;
    module.add_function(wrap_pyfunction!(references::solid::bone_points, module)?)?;
    module.add_function(wrap_pyfunction!(recordings::read_recording, module)?)?;
    module.add_function(wrap_pyfunction!(placing::place_mat, module)?)?;
    module.add_function(wrap_pyfunction!(comparison::compare, module)?)?;
    module.add_function(wrap_pyfunction!(comparison::compare_map, module)?)?;
    module.add_class::<prints::Print>()?;
    module.add_function(wrap_pyfunction!(prints::compare_print, module)?)?;
    module.add_function(wrap_pyfunction!(comparison::spread_map, module)?)?;
    module.add_function(wrap_pyfunction!(
        complementarity::solve_complementarity,
        module
    )?)?;
    module.add_function(wrap_pyfunction!(complementarity::solve_stick_slip, module)?)?;
    module.add_function(wrap_pyfunction!(references::ball::press_ball, module)?)?;
    module.add_function(wrap_pyfunction!(about::parameters, module)?)?;
    module.add_function(wrap_pyfunction!(effects::effects, module)?)?;
    module.add_function(wrap_pyfunction!(parquet_table::parquet, module)?)?;
    module.add_function(wrap_pyfunction!(about::build_info, module)?)?;
    module.add_function(wrap_pyfunction!(running::_panic, module)?)?;
    module.add("__version__", env!("CARGO_PKG_VERSION"))
}
