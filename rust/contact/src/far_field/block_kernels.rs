//! Single-precision blocks times three fields, and their transposes: the inner loops of the far field.

/// Three fields, the components of a vector at every place of a list.
pub type Fields = [Vec<f64>; 3];

/// Three fields of zeros.
pub fn zeros(places: usize) -> Fields {
    [(); 3].map(|()| vec![0.0; places])
}

/// A part of three fields.
pub fn part(fields: &Fields, (first, last): (usize, usize)) -> [&[f64]; 3] {
    [0, 1, 2].map(|axis| &fields[axis][first..last])
}

/// A part of three fields, to be written.
pub fn part_mut(fields: &mut Fields, (first, last): (usize, usize)) -> [&mut [f64]; 3] {
    fields.each_mut().map(|axis| &mut axis[first..last])
}

/// Adds a block (row by row) times `x` to `out`.
#[multiversion::multiversion(targets("x86_64+avx512f+avx512vl", "x86_64+avx2"))]
pub fn add_product(block: &[f32], x: [&[f64]; 3], out: [&mut [f64]; 3]) {
    let columns = x[0].len();
    if columns == 0 {
        return;
    }
    let [out0, out1, out2] = out;
    for (i, row) in block.chunks_exact(columns).enumerate() {
        let mut sums = [[0.0; 8]; 3];
        let mut tails = [0.0; 3];
        let (row8, rest) = row.as_chunks::<8>();
        for axis in 0..3 {
            let (x8, x_rest) = x[axis].as_chunks::<8>();
            let mut sum = [0.0; 8];
            for (a, b) in row8.iter().zip(x8) {
                for lane in 0..8 {
                    sum[lane] += f64::from(a[lane]) * b[lane];
                }
            }
            sums[axis] = sum;
            for (a, b) in rest.iter().zip(x_rest) {
                tails[axis] += f64::from(*a) * b;
            }
        }
        let total = |axis: usize| sums[axis].iter().sum::<f64>() + tails[axis];
        out0[i] += total(0);
        out1[i] += total(1);
        out2[i] += total(2);
    }
}

/// Adds the transpose of a block (row by row) times `x` to `out`.
#[multiversion::multiversion(targets("x86_64+avx512f+avx512vl", "x86_64+avx2"))]
pub fn add_transposed(block: &[f32], x: [&[f64]; 3], out: [&mut [f64]; 3]) {
    let columns = out[0].len();
    if columns == 0 {
        return;
    }
    let [out0, out1, out2] = out;
    let (out1, out2) = (&mut out1[..columns], &mut out2[..columns]);
    for (i, row) in block.chunks_exact(columns).enumerate() {
        let (a, b, c) = (x[0][i], x[1][i], x[2][i]);
        for k in 0..columns {
            let value = f64::from(row[k]);
            out0[k] += value * a;
            out1[k] += value * b;
            out2[k] += value * c;
        }
    }
}
