// Sums of the bands of a light at a direction. Written by tests/sh_basis_source.rs: change that program, not this file.
// Joined before a file that defines light_coefficient(i): the light's coefficient i in three channels.
//
// The basis is y_l,m = p_lm c_m, y_l,-m = p_lm s_m with c_m + i s_m = (x + iy)^m, and p_lm a polynomial of z by the normalised
// recurrence p_lm = a z p_(l-1)m - b p_(l-2)m: no angles, no poles.

const MAX_ORDER: u32 = 10u;

// [l]: the sum over m of y_lm(s) light_coefficient(l(l+1) + m), for the first `count` bands; 0 beyond.
fn light_bands(s: vec3<f32>, count: u32) -> array<vec3<f32>, MAX_ORDER> {
    var bands: array<vec3<f32>, MAX_ORDER>;
    let x = s.x;
    let y = s.y;
    let z = s.z;
    let p00 = 0.2820948;
    bands[0] = p00 * light_coefficient(0u);
    if count < 2u {
        return bands;
    }
    let c1 = x;
    let s1 = y;
    let p10 = 1.7320508 * z * p00;
    let p11 = -0.48860252;
    bands[1] = p10 * light_coefficient(2u)
        + p11 * (c1 * light_coefficient(3u) + s1 * light_coefficient(1u));
    if count < 3u {
        return bands;
    }
    let c2 = x * c1 - y * s1;
    let s2 = x * s1 + y * c1;
    let p20 = 1.9364917 * z * p10 - 1.118034 * p00;
    let p21 = 2.236068 * z * p11;
    let p22 = 0.54627424;
    bands[2] = p20 * light_coefficient(6u)
        + p21 * (c1 * light_coefficient(7u) + s1 * light_coefficient(5u))
        + p22 * (c2 * light_coefficient(8u) + s2 * light_coefficient(4u));
    if count < 4u {
        return bands;
    }
    let c3 = x * c2 - y * s2;
    let s3 = x * s2 + y * c2;
    let p30 = 1.9720266 * z * p20 - 1.0183501 * p10;
    let p31 = 2.09165 * z * p21 - 0.9354144 * p11;
    let p32 = 2.6457512 * z * p22;
    let p33 = -0.5900436;
    bands[3] = p30 * light_coefficient(12u)
        + p31 * (c1 * light_coefficient(13u) + s1 * light_coefficient(11u))
        + p32 * (c2 * light_coefficient(14u) + s2 * light_coefficient(10u))
        + p33 * (c3 * light_coefficient(15u) + s3 * light_coefficient(9u));
    if count < 5u {
        return bands;
    }
    let c4 = x * c3 - y * s3;
    let s4 = x * s3 + y * c3;
    let p40 = 1.9843135 * z * p30 - 1.0062306 * p20;
    let p41 = 2.04939 * z * p31 - 0.9797959 * p21;
    let p42 = 2.291288 * z * p32 - 0.8660254 * p22;
    let p43 = 3.0 * z * p33;
    let p44 = 0.6258357;
    bands[4] = p40 * light_coefficient(20u)
        + p41 * (c1 * light_coefficient(21u) + s1 * light_coefficient(19u))
        + p42 * (c2 * light_coefficient(22u) + s2 * light_coefficient(18u))
        + p43 * (c3 * light_coefficient(23u) + s3 * light_coefficient(17u))
        + p44 * (c4 * light_coefficient(24u) + s4 * light_coefficient(16u));
    if count < 6u {
        return bands;
    }
    let c5 = x * c4 - y * s4;
    let s5 = x * s4 + y * c4;
    let p50 = 1.9899749 * z * p40 - 1.002853 * p30;
    let p51 = 2.0310097 * z * p41 - 0.9910312 * p31;
    let p52 = 2.1712406 * z * p42 - 0.9476071 * p32;
    let p53 = 2.4874685 * z * p43 - 0.8291562 * p33;
    let p54 = 3.3166249 * z * p44;
    let p55 = -0.6563821;
    bands[5] = p50 * light_coefficient(30u)
        + p51 * (c1 * light_coefficient(31u) + s1 * light_coefficient(29u))
        + p52 * (c2 * light_coefficient(32u) + s2 * light_coefficient(28u))
        + p53 * (c3 * light_coefficient(33u) + s3 * light_coefficient(27u))
        + p54 * (c4 * light_coefficient(34u) + s4 * light_coefficient(26u))
        + p55 * (c5 * light_coefficient(35u) + s5 * light_coefficient(25u));
    if count < 7u {
        return bands;
    }
    let c6 = x * c5 - y * s5;
    let s6 = x * s5 + y * c5;
    let p60 = 1.9930434 * z * p50 - 1.001542 * p40;
    let p61 = 2.021315 * z * p51 - 0.9952267 * p41;
    let p62 = 2.113942 * z * p52 - 0.9736101 * p42;
    let p63 = 2.3013682 * z * p53 - 0.9251849 * p43;
    let p64 = 2.6739483 * z * p54 - 0.8062258 * p44;
    let p65 = 3.6055512 * z * p55;
    let p66 = 0.6831841;
    bands[6] = p60 * light_coefficient(42u)
        + p61 * (c1 * light_coefficient(43u) + s1 * light_coefficient(41u))
        + p62 * (c2 * light_coefficient(44u) + s2 * light_coefficient(40u))
        + p63 * (c3 * light_coefficient(45u) + s3 * light_coefficient(39u))
        + p64 * (c4 * light_coefficient(46u) + s4 * light_coefficient(38u))
        + p65 * (c5 * light_coefficient(47u) + s5 * light_coefficient(37u))
        + p66 * (c6 * light_coefficient(48u) + s6 * light_coefficient(36u));
    if count < 8u {
        return bands;
    }
    let c7 = x * c6 - y * s6;
    let s7 = x * s6 + y * c6;
    let p70 = 1.9948914 * z * p60 - 1.0009272 * p50;
    let p71 = 2.0155644 * z * p61 - 0.9971551 * p51;
    let p72 = 2.081666 * z * p62 - 0.9847319 * p52;
    let p73 = 2.20794 * z * p63 - 0.9594032 * p53;
    let p74 = 2.4308622 * z * p64 - 0.90909094 * p54;
    let p75 = 2.8504386 * z * p65 - 0.7905694 * p55;
    let p76 = 3.8729835 * z * p66;
    let p77 = -0.70716274;
    bands[7] = p70 * light_coefficient(56u)
        + p71 * (c1 * light_coefficient(57u) + s1 * light_coefficient(55u))
        + p72 * (c2 * light_coefficient(58u) + s2 * light_coefficient(54u))
        + p73 * (c3 * light_coefficient(59u) + s3 * light_coefficient(53u))
        + p74 * (c4 * light_coefficient(60u) + s4 * light_coefficient(52u))
        + p75 * (c5 * light_coefficient(61u) + s5 * light_coefficient(51u))
        + p76 * (c6 * light_coefficient(62u) + s6 * light_coefficient(50u))
        + p77 * (c7 * light_coefficient(63u) + s7 * light_coefficient(49u));
    if count < 9u {
        return bands;
    }
    let c8 = x * c7 - y * s7;
    let s8 = x * s7 + y * c7;
    let p80 = 1.9960899 * z * p70 - 1.0006008 * p60;
    let p81 = 2.0118694 * z * p71 - 0.9981668 * p61;
    let p82 = 2.0615528 * z * p72 - 0.9903379 * p62;
    let p83 = 2.1532216 * z * p73 - 0.9752174 * p63;
    let p84 = 2.304886 * z * p74 - 0.9481764 * p64;
    let p85 = 2.5570416 * z * p75 - 0.8970695 * p65;
    let p86 = 3.0178044 * z * p76 - 0.7791937 * p66;
    let p87 = 4.1231055 * z * p77;
    let p88 = 0.72892666;
    bands[8] = p80 * light_coefficient(72u)
        + p81 * (c1 * light_coefficient(73u) + s1 * light_coefficient(71u))
        + p82 * (c2 * light_coefficient(74u) + s2 * light_coefficient(70u))
        + p83 * (c3 * light_coefficient(75u) + s3 * light_coefficient(69u))
        + p84 * (c4 * light_coefficient(76u) + s4 * light_coefficient(68u))
        + p85 * (c5 * light_coefficient(77u) + s5 * light_coefficient(67u))
        + p86 * (c6 * light_coefficient(78u) + s6 * light_coefficient(66u))
        + p87 * (c7 * light_coefficient(79u) + s7 * light_coefficient(65u))
        + p88 * (c8 * light_coefficient(80u) + s8 * light_coefficient(64u));
    if count < 10u {
        return bands;
    }
    let c9 = x * c8 - y * s8;
    let s9 = x * s8 + y * c8;
    let p90 = 1.9969112 * z * p80 - 1.0004114 * p70;
    let p91 = 2.0093532 * z * p81 - 0.9987492 * p71;
    let p92 = 2.0481224 * z * p82 - 0.9934853 * p72;
    let p93 = 2.1180441 * z * p83 - 0.98366284 * p73;
    let p94 = 2.2291772 * z * p84 - 0.96715283 * p74;
    let p95 = 2.4016364 * z * p85 - 0.9392246 * p75;
    let p96 = 2.6791375 * z * p86 - 0.8877771 * p76;
    let p97 = 3.1770663 * z * p87 - 0.77055174 * p77;
    let p98 = 4.358899 * z * p88;
    let p99 = -0.74890095;
    bands[9] = p90 * light_coefficient(90u)
        + p91 * (c1 * light_coefficient(91u) + s1 * light_coefficient(89u))
        + p92 * (c2 * light_coefficient(92u) + s2 * light_coefficient(88u))
        + p93 * (c3 * light_coefficient(93u) + s3 * light_coefficient(87u))
        + p94 * (c4 * light_coefficient(94u) + s4 * light_coefficient(86u))
        + p95 * (c5 * light_coefficient(95u) + s5 * light_coefficient(85u))
        + p96 * (c6 * light_coefficient(96u) + s6 * light_coefficient(84u))
        + p97 * (c7 * light_coefficient(97u) + s7 * light_coefficient(83u))
        + p98 * (c8 * light_coefficient(98u) + s8 * light_coefficient(82u))
        + p99 * (c9 * light_coefficient(99u) + s9 * light_coefficient(81u));
    return bands;
}
