//! Struct-of-arrays queues from one field list.
//!
//! `columns! { pub struct PathQueue of Path { origin: V3, slot: U, ... } }` makes the row type `Path<L>` (one path as
//! `Path<f32>`, eight as `Path<F32x8>`) and the queue `PathQueue` that holds each field in columns of its own.

mod column;

pub use column::Column;

use crate::lanes::{Lanes, LanesU32, MAX_LANES, Vec3};

/// Which rows of a queue a group of lanes stands for. Groups shorter than the lanes repeat their last row.
#[derive(Clone, Copy, Debug)]
pub struct Rows {
    index: [u32; MAX_LANES],
    count: usize,
    contiguous: bool,
}

impl Rows {
    /// The rows `index[0..n]` in ascending order, n in 1..=8.
    #[inline(always)]
    pub fn listed(index: &[u32]) -> Self {
        let rows = Self::scattered(index);
        // Lists of rows ascend, so equal distance of the ends means no gap.
        let distance = rows.index[MAX_LANES - 1].wrapping_sub(rows.index[0]);
        let contiguous = rows.count == MAX_LANES && distance == MAX_LANES as u32 - 1;
        Self { contiguous, ..rows }
    }
    /// The rows `index[0..n]` in any order, n in 1..=8.
    #[inline(always)]
    pub fn scattered(index: &[u32]) -> Self {
        let count = index.len().min(MAX_LANES);
        let mut rows = [index[count - 1]; MAX_LANES];
        rows[..count].copy_from_slice(&index[..count]);
        Self { index: rows, count, contiguous: false }
    }
    /// The `count` rows from `first` on, `count` in 1..=8.
    #[inline(always)]
    pub fn range(first: usize, count: usize) -> Self {
        let (first, last) = (first as u32, (first + count) as u32 - 1);
        let at = |i: u32| (first + i).min(last);
        let index = [at(0), at(1), at(2), at(3), at(4), at(5), at(6), at(7)];
        Self { index, count, contiguous: count == MAX_LANES }
    }
    /// The same rows, `by` further on.
    #[inline(always)]
    pub fn shifted(&self, by: usize) -> Self {
        Self { index: self.index.map(|i| i + by as u32), ..*self }
    }
    /// Row of lane `i`.
    #[inline(always)]
    pub fn at(&self, i: usize) -> usize {
        self.index[i] as usize
    }
    /// Number of live lanes.
    #[inline(always)]
    pub fn count(&self) -> usize {
        self.count
    }
    /// Bits of the live lanes.
    #[inline(always)]
    pub fn live(&self) -> u32 {
        (1u32 << self.count) - 1
    }
}

/// How a field is stored in columns and how it looks in lanes.
pub trait Field {
    /// The columns.
    type Store: Clone + std::fmt::Debug;
    /// The field of a group of rows.
    type Value<L: Lanes>: Copy;
    /// Bytes per row.
    const BYTES: usize;
    /// Columns of `rows` rows.
    fn with_rows(rows: usize) -> Self::Store;
    /// Reads a group.
    fn gather<L: Lanes>(store: &Self::Store, rows: &Rows) -> Self::Value<L>;
    /// Writes the live lanes of a group.
    fn scatter<L: Lanes>(store: &mut Self::Store, rows: &Rows, value: Self::Value<L>);
    /// Writes the lanes whose bit is set one after another from row `at` on; may overwrite up to 8 rows from there.
    fn append<L: Lanes>(store: &mut Self::Store, at: usize, bits: u32, value: Self::Value<L>);
}

/// A column of `f32`.
#[derive(Debug)]
pub struct F;
/// A column of `u32`.
#[derive(Debug)]
pub struct U;
/// Three columns of `f32`.
#[derive(Debug)]
pub struct V3;
/// Two columns of `u32`.
#[derive(Debug)]
pub struct U2;

impl Field for F {
    type Store = Column<f32>;
    type Value<L: Lanes> = L;
    const BYTES: usize = 4;
    fn with_rows(rows: usize) -> Column<f32> {
        Column::zeros(rows)
    }
    #[inline(always)]
    fn gather<L: Lanes>(store: &Column<f32>, rows: &Rows) -> L {
        if rows.contiguous && L::N == MAX_LANES {
            L::load(&store[rows.at(0)..])
        } else {
            L::from_fn(|i| store[rows.at(i)])
        }
    }
    #[inline(always)]
    fn scatter<L: Lanes>(store: &mut Column<f32>, rows: &Rows, value: L) {
        if rows.contiguous && L::N == MAX_LANES {
            value.store(&mut store[rows.at(0)..]);
        } else {
            for (i, &v) in value.array().as_ref().iter().enumerate().take(rows.count) {
                store[rows.at(i)] = v;
            }
        }
    }
    #[inline(always)]
    fn append<L: Lanes>(store: &mut Column<f32>, at: usize, bits: u32, value: L) {
        value.pack(bits).store(&mut store[at..]);
    }
}

impl Field for U {
    type Store = Column<u32>;
    type Value<L: Lanes> = L::Uint;
    const BYTES: usize = 4;
    fn with_rows(rows: usize) -> Column<u32> {
        Column::zeros(rows)
    }
    #[inline(always)]
    fn gather<L: Lanes>(store: &Column<u32>, rows: &Rows) -> L::Uint {
        if rows.contiguous && L::N == MAX_LANES {
            L::Uint::load(&store[rows.at(0)..])
        } else {
            L::Uint::from_fn(|i| store[rows.at(i)])
        }
    }
    #[inline(always)]
    fn scatter<L: Lanes>(store: &mut Column<u32>, rows: &Rows, value: L::Uint) {
        if rows.contiguous && L::N == MAX_LANES {
            value.store(&mut store[rows.at(0)..]);
        } else {
            for (i, &v) in value.array().as_ref().iter().enumerate().take(rows.count) {
                store[rows.at(i)] = v;
            }
        }
    }
    #[inline(always)]
    fn append<L: Lanes>(store: &mut Column<u32>, at: usize, bits: u32, value: L::Uint) {
        value.pack(bits).store(&mut store[at..]);
    }
}

impl Field for V3 {
    type Store = [Column<f32>; 3];
    type Value<L: Lanes> = Vec3<L>;
    const BYTES: usize = 12;
    fn with_rows(rows: usize) -> [Column<f32>; 3] {
        std::array::from_fn(|_| F::with_rows(rows))
    }
    #[inline(always)]
    fn gather<L: Lanes>(s: &[Column<f32>; 3], rows: &Rows) -> Vec3<L> {
        Vec3::new(F::gather(&s[0], rows), F::gather(&s[1], rows), F::gather(&s[2], rows))
    }
    #[inline(always)]
    fn scatter<L: Lanes>([x, y, z]: &mut [Column<f32>; 3], rows: &Rows, value: Vec3<L>) {
        F::scatter(x, rows, value.x);
        F::scatter(y, rows, value.y);
        F::scatter(z, rows, value.z);
    }
    #[inline(always)]
    fn append<L: Lanes>([x, y, z]: &mut [Column<f32>; 3], at: usize, bits: u32, value: Vec3<L>) {
        F::append(x, at, bits, value.x);
        F::append(y, at, bits, value.y);
        F::append(z, at, bits, value.z);
    }
}

impl Field for U2 {
    type Store = [Column<u32>; 2];
    type Value<L: Lanes> = [L::Uint; 2];
    const BYTES: usize = 8;
    fn with_rows(rows: usize) -> [Column<u32>; 2] {
        std::array::from_fn(|_| U::with_rows(rows))
    }
    #[inline(always)]
    fn gather<L: Lanes>([a, b]: &[Column<u32>; 2], rows: &Rows) -> [L::Uint; 2] {
        [U::gather::<L>(a, rows), U::gather::<L>(b, rows)]
    }
    #[inline(always)]
    fn scatter<L: Lanes>(store: &mut [Column<u32>; 2], rows: &Rows, value: [L::Uint; 2]) {
        for (column, v) in store.iter_mut().zip(value) {
            U::scatter::<L>(column, rows, v);
        }
    }
    #[inline(always)]
    fn append<L: Lanes>(store: &mut [Column<u32>; 2], at: usize, bits: u32, value: [L::Uint; 2]) {
        for (column, v) in store.iter_mut().zip(value) {
            U::append::<L>(column, at, bits, v);
        }
    }
}

/// Makes a row type and the queue that holds it in columns; see the module's documentation.
macro_rules! columns {
    ($(#[$doc:meta])* pub struct $queue:ident of $row:ident { $($(#[$fdoc:meta])* $field:ident: $kind:ident,)* }) => {
        #[doc = concat!("A group of rows of `", stringify!($queue), "`, in lanes.")]
        #[derive(Clone, Copy, Debug)]
        pub struct $row<L: $crate::lanes::Lanes> {
            $($(#[$fdoc])* pub $field: <$crate::columns::$kind as $crate::columns::Field>::Value<L>,)*
        }

        $(#[$doc])*
        #[derive(Clone, Debug)]
        pub struct $queue {
            len: usize,
            $($field: <$crate::columns::$kind as $crate::columns::Field>::Store,)*
        }

        #[allow(dead_code, reason = "a queue has all of its methods, whether or not a stage uses them")]
        impl $queue {
            /// Bytes that one row takes over all columns.
            pub const ROW_BYTES: usize = 0 $(+ <$crate::columns::$kind as $crate::columns::Field>::BYTES)*;

            /// Names and bytes of the columns.
            pub const COLUMNS: &'static [(&'static str, usize)] =
                &[$((stringify!($field), <$crate::columns::$kind as $crate::columns::Field>::BYTES),)*];

            /// An empty queue with room for `capacity` rows.
            pub fn with_capacity(capacity: usize) -> Self {
                let rows = capacity + $crate::lanes::MAX_LANES;
                Self { len: 0, $($field: <$crate::columns::$kind as $crate::columns::Field>::with_rows(rows),)* }
            }
            /// Number of rows.
            #[inline(always)]
            pub fn len(&self) -> usize {
                self.len
            }
            /// Whether there are no rows.
            #[inline(always)]
            pub fn is_empty(&self) -> bool {
                self.len == 0
            }
            /// Forgets all rows.
            pub fn clear(&mut self) {
                self.len = 0;
            }
            /// Reads a group of rows.
            #[inline(always)]
            pub fn gather<L: $crate::lanes::Lanes>(&self, rows: &$crate::columns::Rows) -> $row<L> {
                $row { $($field: <$crate::columns::$kind as $crate::columns::Field>::gather::<L>(&self.$field, rows),)* }
            }
            /// Writes the live lanes of a group of rows.
            #[inline(always)]
            pub fn scatter<L: $crate::lanes::Lanes>(&mut self, rows: &$crate::columns::Rows, value: $row<L>) {
                $(<$crate::columns::$kind as $crate::columns::Field>::scatter::<L>(&mut self.$field, rows, value.$field);)*
            }
            /// Appends the lanes whose bit is set, in order.
            #[inline(always)]
            pub fn append<L: $crate::lanes::Lanes>(&mut self, bits: u32, value: $row<L>) {
                self.put(self.len, bits, value);
                self.len += bits.count_ones() as usize;
            }
            /// Writes the lanes whose bit is set one after another from row `at` on. The eight rows from there must have
            /// been read: what comes after the lanes is unspecified.
            #[inline(always)]
            pub fn put<L: $crate::lanes::Lanes>(&mut self, at: usize, bits: u32, value: $row<L>) {
                $(<$crate::columns::$kind as $crate::columns::Field>::append::<L>(&mut self.$field, at, bits, value.$field);)*
            }
            /// Keeps the first `len` rows.
            #[inline(always)]
            pub fn truncate(&mut self, len: usize) {
                self.len = self.len.min(len);
            }
            $(
                #[doc = concat!("The field `", stringify!($field), "` of a group of rows.")]
                #[inline(always)]
                pub fn $field<L: $crate::lanes::Lanes>(&self, rows: &$crate::columns::Rows)
                    -> <$crate::columns::$kind as $crate::columns::Field>::Value<L> {
                    <$crate::columns::$kind as $crate::columns::Field>::gather::<L>(&self.$field, rows)
                }
            )*
        }
    };
}
pub(crate) use columns;

#[cfg(test)]
mod tests {
    use super::*;
    use crate::lanes::F32x8;

    columns! {
        /// A queue for the test.
        pub struct TestQueue of TestRow { point: V3, weight: F, slot: U, state: U2, }
    }

    fn row(i: f32) -> TestRow<f32> {
        let k = i as u32;
        TestRow { point: Vec3::new(i, i + 0.1, i + 0.2), weight: -i, slot: k, state: [k, k + 1] }
    }

    #[test]
    fn rows_survive_append_gather_scatter_and_packing() {
        let mut q = TestQueue::with_capacity(20);
        for i in 0..20 {
            q.append::<f32>(1, row(i as f32));
        }
        assert_eq!((q.len(), TestQueue::ROW_BYTES), (20, 28));
        let group = q.gather::<F32x8>(&Rows::listed(&[3, 7, 9]));
        assert_eq!(group.weight.array(), [-3.0, -7.0, -9.0, -9.0, -9.0, -9.0, -9.0, -9.0]);
        assert_eq!(group.state[1].array()[1], 8);
        q.scatter::<F32x8>(&Rows::listed(&[0, 2]), group);
        assert_eq!(q.slot::<f32>(&Rows::range(0, 1)), 3);
        assert_eq!(q.slot::<f32>(&Rows::range(1, 1)), 1, "rows between stay");
        assert_eq!(q.slot::<f32>(&Rows::range(3, 1)), 3, "lanes past the live ones are not written");
        let four = q.gather::<F32x8>(&Rows::range(16, 4));
        q.put(15, 0b1010, four);
        q.truncate(17);
        assert_eq!((q.len(), q.slot::<f32>(&Rows::range(15, 1)), q.slot::<f32>(&Rows::range(16, 1))), (17, 17, 19));
        let eight = q.gather::<F32x8>(&Rows::range(4, 8));
        let mut packed = TestQueue::with_capacity(8);
        packed.append::<F32x8>(0b1001_0010, eight);
        let slots: Vec<u32> = (0..packed.len()).map(|i| packed.slot::<f32>(&Rows::range(i, 1))).collect();
        assert_eq!(slots, [5, 8, 11]);
    }
}
