//! The native Python module: exports, arrays, one error table. Knows no algorithm.

mod conversion;
mod hand;
mod measured;
mod press;
mod references;
mod complementarity;
mod parquet_table;
mod about;

use pyo3::prelude::*;

/// Contact of soft skin with products: forces, pressures and shapes, in mm, N, MPa and s.
#[pymodule]
fn thenar(module: &Bound<'_, PyModule>) -> PyResult<()> {
    conversion::running::keep_panics_off_the_terminal();
    conversion::errors::register(module)?;
    conversion::ending::register(module)?;
    conversion::record::register(module)?;
    module.add_class::<press::material::Material>()?;
    module.add_class::<press::product::Product>()?;
    module.add_class::<press::effects::Effect>()?;
    module.add_class::<press::skin::elastomer::Elastomer>()?;
    module.add_class::<press::protocol::Course>()?;
    module.add_class::<press::skin::Skin>()?;
    module.add_class::<press::walk::Walk>()?;
    module.add_class::<press::instrument::Mat>()?;
    module.add_function(wrap_pyfunction!(press::instrument::observe, module)?)?;
    module.add_class::<press::contact::Contact>()?;
    module.add_class::<measured::study::Study>()?;
    module.add_class::<measured::comparison::Comparison>()?;
    module.add_class::<measured::diagnosis::Diagnosis>()?;
    module.add_function(wrap_pyfunction!(measured::diagnosis::diagnose, module)?)?;
    module.add_function(wrap_pyfunction!(hand::hand, module)?)?;
    module.add_function(wrap_pyfunction!(
        references::solid::reference_press,
        module
    )?)?;
    module.add_function(wrap_pyfunction!(references::solid::bone_points, module)?)?;
    module.add_function(wrap_pyfunction!(
        measured::recordings::read_recording,
        module
    )?)?;
    module.add_function(wrap_pyfunction!(measured::placing::place_mat, module)?)?;
    module.add_function(wrap_pyfunction!(measured::comparison::compare, module)?)?;
    module.add_function(wrap_pyfunction!(measured::comparison::compare_map, module)?)?;
    module.add_class::<measured::prints::Print>()?;
    module.add_function(wrap_pyfunction!(
        measured::print_comparison::compare_print,
        module
    )?)?;
    module.add_function(wrap_pyfunction!(measured::comparison::spread_map, module)?)?;
    module.add_function(wrap_pyfunction!(
        complementarity::solve_complementarity,
        module
    )?)?;
    module.add_function(wrap_pyfunction!(complementarity::solve_stick_slip, module)?)?;
    module.add_function(wrap_pyfunction!(references::ball::press_ball, module)?)?;
    module.add_function(wrap_pyfunction!(about::parameters, module)?)?;
    module.add_function(wrap_pyfunction!(press::effects::effects, module)?)?;
    module.add_function(wrap_pyfunction!(parquet_table::parquet, module)?)?;
    module.add_function(wrap_pyfunction!(about::build_info, module)?)?;
    module.add_function(wrap_pyfunction!(conversion::running::_panic, module)?)?;
    module.add("__version__", env!("CARGO_PKG_VERSION"))
}
