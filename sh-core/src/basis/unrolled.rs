//! Straight-line kernels for small orders. Written by `tests/unrolled_source.rs`: change that program, not this file.
//!
//! For m ≥ 0, `y_lm = p cos`, `y_l−m = p sin`, with `cos + i sin = (x + iy)^m` and `p` a polynomial: `p(v)` for even l − m,
//! `z p(v)` for odd, where `v = 2z² − 1`. In `v` the coefficients are small, and its rounding near the poles costs a
//! quarter of that of z. Column `m` of every order is one function, cut off at the constant order `N`.

use super::Sink;
use crate::Real;
use crate::simd::Lanes;

/// The largest order that has a kernel.
#[cfg(feature = "alloc")]
pub(super) const MAX_ORDER: usize = 10;

/// Hands every `y_i` of order `N` to `sink`, column by column.
#[inline(always)]
pub(super) fn kernel<T: Real, V: Lanes<T>, const N: usize>([x, y, z]: [V; 3], sink: &mut impl Sink<V>) {
    let zv = [z, polynomial_argument([x, y, z])];
    column_0::<T, V, N>(zv, sink);
    let (mut c, mut s) = (x, y);
    if N > 1 {
        column_1::<T, V, N>([c, s], zv, sink);
    }
    if N > 2 {
        (c, s) = turn::<T, V>([x, y], [c, s]);
        column_2::<T, V, N>([c, s], zv, sink);
    }
    if N > 3 {
        (c, s) = turn::<T, V>([x, y], [c, s]);
        column_3::<T, V, N>([c, s], zv, sink);
    }
    if N > 4 {
        (c, s) = turn::<T, V>([x, y], [c, s]);
        column_4::<T, V, N>([c, s], zv, sink);
    }
    if N > 5 {
        (c, s) = turn::<T, V>([x, y], [c, s]);
        column_5::<T, V, N>([c, s], zv, sink);
    }
    if N > 6 {
        (c, s) = turn::<T, V>([x, y], [c, s]);
        column_6::<T, V, N>([c, s], zv, sink);
    }
    if N > 7 {
        (c, s) = turn::<T, V>([x, y], [c, s]);
        column_7::<T, V, N>([c, s], zv, sink);
    }
    if N > 8 {
        (c, s) = turn::<T, V>([x, y], [c, s]);
        column_8::<T, V, N>([c, s], zv, sink);
    }
    if N > 9 {
        (c, s) = turn::<T, V>([x, y], [c, s]);
        column_9::<T, V, N>([c, s], zv, sink);
    }
}

/// `(x + iy)(c + is)`
#[inline(always)]
fn turn<T: Real, V: Lanes<T>>([x, y]: [V; 2], [c, s]: [V; 2]) -> (V, V) {
    (x.mul_add(c, -(y * s)), x.mul_add(s, y * c))
}

/// `2z² − 1`, near the poles from x and y, where z has lost digits.
#[inline(always)]
fn polynomial_argument<T: Real, V: Lanes<T>>([x, y, z]: [V; 3]) -> V {
    let (one, two) = (V::splat(T::ONE), V::splat(T::ONE + T::ONE));
    let (radius2, height2) = (x.mul_add(x, y * y), z * z);
    radius2.select_less(height2, one - two * radius2, two * height2 - one)
}

#[inline(always)]
fn column_0<T: Real, V: Lanes<T>, const N: usize>([z, v]: [V; 2], sink: &mut impl Sink<V>) {
    let k = |number: f64| V::splat(T::from_f64(number));
    let p = k(0.28209479177387814);
    sink.put(0, p);
    if N > 1 {
        let p = k(0.4886025119029199);
        let p = p * z;
        sink.put(2, p);
    }
    if N > 2 {
        let p = k(0.47308734787878004);
        let p = p.mul_add(v, k(0.15769578262626002));
        sink.put(6, p);
    }
    if N > 3 {
        let p = k(0.9329408314752885);
        let p = p.mul_add(v, k(-0.1865881662950577));
        let p = p * z;
        sink.put(12, p);
    }
    if N > 4 {
        let p = k(0.9256235355080377);
        let p = p.mul_add(v, k(0.26446386728801075));
        let p = p.mul_add(v, k(-0.343803027474414));
        sink.put(20, p);
    }
    if N > 5 {
        let p = k(1.8419675786414218);
        let p = p.mul_add(v, k(-0.4093261285869826));
        let p = p.mul_add(v, k(-0.4970388704270503));
        let p = p * z;
        sink.put(30, p);
    }
    if N > 6 {
        let p = k(1.8355607154777707);
        let p = p.mul_add(v, k(0.5006074678575738));
        let p = p.mul_add(v, k(-1.1680840916676722));
        let p = p.mul_add(v, k(-0.1509768553856175));
        sink.put(42, p);
    }
    if N > 7 {
        let p = k(3.6617443494062654);
        let p = p.mul_add(v, k(-0.8450179267860612));
        let p = p.mul_add(v, k(-1.9204952881501391));
        let p = p.mul_add(v, k(0.19631729612201423));
        let p = p * z;
        sink.put(56, p);
    }
    if N > 8 {
        let p = k(3.654585507076297);
        let p = p.mul_add(v, k(0.9745561352203459));
        let p = p.mul_add(v, k(-3.261014760160388));
        let p = p.mul_add(v, k(-0.5520213073625735));
        let p = p.mul_add(v, k(0.3470010481466383));
        sink.put(72, p);
    }
    if N > 9 {
        let p = k(7.2978827124136885);
        let p = p.mul_add(v, k(-1.7171488735091032));
        let p = p.mul_add(v, k(-5.666591282580041));
        let p = p.mul_add(v, k(0.8189479242889569));
        let p = p.mul_add(v, k(0.49653220922798197));
        let p = p * z;
        sink.put(90, p);
    }
}

#[inline(always)]
fn column_1<T: Real, V: Lanes<T>, const N: usize>([c, s]: [V; 2], [z, v]: [V; 2], sink: &mut impl Sink<V>) {
    let k = |number: f64| V::splat(T::from_f64(number));
    let p = k(-0.4886025119029199);
    sink.put(1, p * s);
    sink.put(3, p * c);
    if N > 2 {
        let p = k(-1.0925484305920792);
        let p = p * z;
        sink.put(5, p * s);
        sink.put(7, p * c);
    }
    if N > 3 {
        let p = k(-1.1426144986611644);
        let p = p.mul_add(v, k(-0.6855686991966986));
        sink.put(11, p * s);
        sink.put(13, p * c);
    }
    if N > 4 {
        let p = k(-2.341662902450512);
        let p = p.mul_add(v, k(-0.33452327177864455));
        let p = p * z;
        sink.put(19, p * s);
        sink.put(21, p * c);
    }
    if N > 5 {
        let p = k(-2.377969918777409);
        let p = p.mul_add(v, k(-1.5853132791849394));
        let p = p.mul_add(v, k(0.33970998839677274));
        sink.put(29, p * s);
        sink.put(31, p * c);
    }
    if N > 6 {
        let p = k(-4.806626240779534);
        let p = p.mul_add(v, k(-0.8739320437780971));
        let p = p.mul_add(v, k(1.01958738440778));
        let p = p * z;
        sink.put(41, p * s);
        sink.put(43, p * c);
    }
    if N > 7 {
        let p = k(-4.844032456612491);
        let p = p.mul_add(v, k(-3.3535609315009554));
        let p = p.mul_add(v, k(1.7275919950156438));
        let p = p.mul_add(v, k(0.6887785078166946));
        sink.put(55, p * s);
        sink.put(57, p * c);
    }
    if N > 8 {
        let p = k(-9.74556135220346);
        let p = p.mul_add(v, k(-1.9491122704406918));
        let p = p.mul_add(v, k(4.348019680213851));
        let p = p.mul_add(v, k(0.3680142049083824));
        let p = p * z;
        sink.put(71, p * s);
        sink.put(73, p * c);
    }
    if N > 9 {
        let p = k(-9.791137102066536);
        let p = p.mul_add(v, k(-6.911390895576377));
        let p = p.mul_add(v, k(5.759492412980315));
        let p = p.mul_add(v, k(3.0126575698666263));
        let p = p.mul_add(v, k(-0.3181817486891223));
        sink.put(89, p * s);
        sink.put(91, p * c);
    }
}

#[inline(always)]
fn column_2<T: Real, V: Lanes<T>, const N: usize>([c, s]: [V; 2], [z, v]: [V; 2], sink: &mut impl Sink<V>) {
    let k = |number: f64| V::splat(T::from_f64(number));
    let p = k(0.5462742152960396);
    sink.put(4, p * s);
    sink.put(8, p * c);
    if N > 3 {
        let p = k(1.4453057213202771);
        let p = p * z;
        sink.put(10, p * s);
        sink.put(14, p * c);
    }
    if N > 4 {
        let p = k(1.65580571757573);
        let p = p.mul_add(v, k(1.18271836969695));
        sink.put(18, p * s);
        sink.put(22, p * c);
    }
    if N > 5 {
        let p = k(3.595152588729993);
        let p = p.mul_add(v, k(1.198384196243331));
        let p = p * z;
        sink.put(28, p * s);
        sink.put(32, p * c);
    }
    if N > 6 {
        let p = k(3.7999716954990594);
        let p = p.mul_add(v, k(3.454519723180963));
        let p = p.mul_add(v, k(0.11515065743936544));
        sink.put(40, p * s);
        sink.put(44, p * c);
    }
    if N > 7 {
        let p = k(7.910271877454065);
        let p = p.mul_add(v, k(3.6508947126711067));
        let p = p.mul_add(v, k(-0.9403819714455881));
        let p = p * z;
        sink.put(54, p * s);
        sink.put(58, p * c);
    }
    if N > 8 {
        let p = k(8.153721619524006);
        let p = p.mul_add(v, k(8.153721619524006));
        let p = p.mul_add(v, k(-0.6272093553480005));
        let p = p.mul_add(v, k(-1.0833616137829098));
        sink.put(70, p * s);
        sink.put(74, p * c);
    }
    if N > 9 {
        let p = k(16.699819552772645);
        let p = p.mul_add(v, k(8.841080939703165));
        let p = p.mul_add(v, k(-4.911711633168425));
        let p = p.mul_add(v, k(-1.2846015040594343));
        let p = p * z;
        sink.put(88, p * s);
        sink.put(92, p * c);
    }
}

#[inline(always)]
fn column_3<T: Real, V: Lanes<T>, const N: usize>([c, s]: [V; 2], [z, v]: [V; 2], sink: &mut impl Sink<V>) {
    let k = |number: f64| V::splat(T::from_f64(number));
    let p = k(-0.5900435899266435);
    sink.put(9, p * s);
    sink.put(15, p * c);
    if N > 4 {
        let p = k(-1.7701307697799307);
        let p = p * z;
        sink.put(17, p * s);
        sink.put(23, p * c);
    }
    if N > 5 {
        let p = k(-2.201572347458627);
        let p = p.mul_add(v, k(-1.7123340480233764));
        sink.put(27, p * s);
        sink.put(33, p * c);
    }
    if N > 6 {
        let p = k(-5.066628927332079);
        let p = p.mul_add(v, k(-2.3030131487873087));
        let p = p * z;
        sink.put(39, p * s);
        sink.put(45, p * c);
    }
    if N > 7 {
        let p = k(-5.5934068855770125);
        let p = p.mul_add(v, k(-6.023668953698321));
        let p = p.mul_add(v, k(-0.8996388697081908));
        sink.put(53, p * s);
        sink.put(59, p * c);
    }
    if N > 8 {
        let p = k(-12.043845014131556);
        let p = p.mul_add(v, k(-8.029230009421036));
        let p = p.mul_add(v, k(0.30881653882388604));
        let p = p * z;
        sink.put(69, p * s);
        sink.put(75, p * c);
    }
    if N > 9 {
        let p = k(-12.75469786544737);
        let p = p.mul_add(v, k(-15.755803245552634));
        let p = p.mul_add(v, k(-2.2508290350789477));
        let p = p.mul_add(v, k(1.2119848650425105));
        sink.put(87, p * s);
        sink.put(93, p * c);
    }
}

#[inline(always)]
fn column_4<T: Real, V: Lanes<T>, const N: usize>([c, s]: [V; 2], [z, v]: [V; 2], sink: &mut impl Sink<V>) {
    let k = |number: f64| V::splat(T::from_f64(number));
    let p = k(0.6258357354491761);
    sink.put(16, p * s);
    sink.put(24, p * c);
    if N > 5 {
        let p = k(2.0756623148810416);
        let p = p * z;
        sink.put(26, p * s);
        sink.put(34, p * c);
    }
    if N > 6 {
        let p = k(2.775106954007983);
        let p = p.mul_add(v, k(2.2705420532792586));
        sink.put(38, p * s);
        sink.put(46, p * c);
    }
    if N > 7 {
        let p = k(6.745902523363385);
        let p = p.mul_add(v, k(3.6324090510418223));
        let p = p * z;
        sink.put(52, p * s);
        sink.put(60, p * c);
    }
    if N > 8 {
        let p = k(7.774268527339124);
        let p = p.mul_add(v, k(9.329122232806949));
        let p = p.mul_add(v, k(2.0332702302271555));
        sink.put(68, p * s);
        sink.put(76, p * c);
    }
    if N > 9 {
        let p = k(17.33022176459899);
        let p = p.mul_add(v, k(14.271947335552106));
        let p = p.mul_add(v, k(1.0194248096822933));
        let p = p * z;
        sink.put(86, p * s);
        sink.put(94, p * c);
    }
}

#[inline(always)]
fn column_5<T: Real, V: Lanes<T>, const N: usize>([c, s]: [V; 2], [z, v]: [V; 2], sink: &mut impl Sink<V>) {
    let k = |number: f64| V::splat(T::from_f64(number));
    let p = k(-0.6563820568401701);
    sink.put(25, p * s);
    sink.put(35, p * c);
    if N > 6 {
        let p = k(-2.366619162231752);
        let p = p * z;
        sink.put(37, p * s);
        sink.put(47, p * c);
    }
    if N > 7 {
        let p = k(-3.372951261681692);
        let p = p.mul_add(v, k(-2.854035682961432));
        sink.put(51, p * s);
        sink.put(61, p * c);
    }
    if N > 8 {
        let p = k(-8.62477655524527);
        let p = p.mul_add(v, k(-5.174865933147162));
        let p = p * z;
        sink.put(67, p * s);
        sink.put(77, p * c);
    }
    if N > 9 {
        let p = k(-10.356788429579144);
        let p = p.mul_add(v, k(-13.40290267357301));
        let p = p.mul_add(v, k(-3.5334925230328844));
        sink.put(85, p * s);
        sink.put(95, p * c);
    }
}

#[inline(always)]
fn column_6<T: Real, V: Lanes<T>, const N: usize>([c, s]: [V; 2], [z, v]: [V; 2], sink: &mut impl Sink<V>) {
    let k = |number: f64| V::splat(T::from_f64(number));
    let p = k(0.6831841051919143);
    sink.put(36, p * s);
    sink.put(48, p * c);
    if N > 7 {
        let p = k(2.6459606618019);
        let p = p * z;
        sink.put(50, p * s);
        sink.put(62, p * c);
    }
    if N > 8 {
        let p = k(3.9924957454465693);
        let p = p.mul_add(v, k(3.460162979387027));
        sink.put(66, p * s);
        sink.put(78, p * c);
    }
    if N > 9 {
        let p = k(10.696445095454319);
        let p = p.mul_add(v, k(6.921229179411618));
        let p = p * z;
        sink.put(84, p * s);
        sink.put(96, p * c);
    }
}

#[inline(always)]
fn column_7<T: Real, V: Lanes<T>, const N: usize>([c, s]: [V; 2], [z, v]: [V; 2], sink: &mut impl Sink<V>) {
    let k = |number: f64| V::splat(T::from_f64(number));
    let p = k(-0.7071627325245963);
    sink.put(49, p * s);
    sink.put(63, p * c);
    if N > 8 {
        let p = k(-2.9157066406993195);
        let p = p * z;
        sink.put(65, p * s);
        sink.put(79, p * c);
    }
    if N > 9 {
        let p = k(-4.631696591424452);
        let p = p.mul_add(v, k(-4.086791110080399));
        sink.put(83, p * s);
        sink.put(97, p * c);
    }
}

#[inline(always)]
fn column_8<T: Real, V: Lanes<T>, const N: usize>([c, s]: [V; 2], [z, _]: [V; 2], sink: &mut impl Sink<V>) {
    let k = |number: f64| V::splat(T::from_f64(number));
    let p = k(0.7289266601748299);
    sink.put(64, p * s);
    sink.put(80, p * c);
    if N > 9 {
        let p = k(3.1773176489546975);
        let p = p * z;
        sink.put(82, p * s);
        sink.put(98, p * c);
    }
}

#[inline(always)]
fn column_9<T: Real, V: Lanes<T>, const N: usize>([c, s]: [V; 2], _: [V; 2], sink: &mut impl Sink<V>) {
    let k = |number: f64| V::splat(T::from_f64(number));
    let p = k(-0.7489009518531884);
    sink.put(81, p * s);
    sink.put(99, p * c);
}
