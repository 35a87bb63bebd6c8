"""Writes zonal_kernels.txt: the means A_l of the Legendre polynomials under the kernels of sh-core, to 17 digits.

Needs mpmath (1.4.1 was used): pip install mpmath; python zonal_kernels.py > zonal_kernels.txt
Each line: kernel parameter l A_l. The formulas are not those of the crate: gamma functions, Bessel functions,
hypergeometric functions and Legendre polynomials from mpmath, at 60 digits and more.
"""
from mpmath import besseli, cos, gamma, hyp2f1, legendre, mp, mpf, pi, sqrt

BANDS = [0, 1, 2, 3, 4, 7, 16, 63, 64, 65, 200, 511]


def phong(s, l):
    # Integral of z^s P_l over [0, 1]: DLMF 18.17.38 and 18.17.39 in one form.
    integral = lambda l: sqrt(pi) * gamma(1 + s) / (
        mpf(2) ** (s + 1)) * mp.rgamma(1 + (s - l) / 2) * mp.rgamma((s + l + 3) / 2)
    return integral(l) / integral(0)


def cap(radius, l):
    z = cos(radius)
    return mpf(1) if l == 0 else (legendre(l - 1, z) - legendre(l + 1, z)) / ((2 * l + 1) * (1 - z))


def von_mises_fisher(k, l):
    return besseli(l + mpf(1) / 2, k) / besseli(mpf(1) / 2, k)


def legendre_q(l, a):
    # DLMF 14.3.7 with mu = 0
    return sqrt(pi) * gamma(l + 1) / (gamma(l + mpf(3) / 2) * (2 * a) ** (l + 1)) * hyp2f1(
        mpf(l + 1) / 2, mpf(l + 2) / 2, l + mpf(3) / 2, 1 / a**2)


def ggx(alpha, l):
    # −(a² − 1) Q_l'(a), by DLMF 14.10.5
    a = (1 + alpha**2) / (1 - alpha**2)
    return mpf(1) if l == 0 else l * (legendre_q(l - 1, a) - a * legendre_q(l, a))


KERNELS = [
    (phong, ["1e-300", "0.5", "1", "3", "10.25", "100", "1e4", "1e8"]),
    (cap, ["1e-150", "1e-8", "1e-3", "0.1", "0.5", "1.5", "1.75", "2.5", "3", "3.125", "3.141592"]),
    (von_mises_fisher, ["1e-300", "1e-3", "0.5", "1", "3", "10", "60", "500", "4000", "1e5", "262143", "262145", "1e6", "1e8"]),
    (ggx, ["1e-150", "1e-6", "1e-3", "0.0019", "0.00196", "0.01", "0.015625", "0.1", "0.3", "0.5", "0.8", "0.99"]),
]

for kernel, parameters in KERNELS:
    for parameter in parameters:
        # The number that the crate reads, exactly.
        value = mpf(float(parameter))
        for l in BANDS:
            mp.dps = 700 if float(parameter) < 1e-100 else 80
            print(kernel.__name__, parameter, l, mp.nstr(kernel(value, l), 17, min_fixed=0, max_fixed=0))
