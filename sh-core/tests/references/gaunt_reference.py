"""Exact Gaunt coefficients of real harmonics from SymPy 1.14: `python3 gaunt_reference.py > gaunt.txt`.

Lines are `l m l m l m value`. SymPy's real harmonics have the phase (-1)^m in their definition or not: since the m of a
coefficient that is not zero add up to an even number, it cancels.
"""
import random
from sympy import N
from sympy.physics.wigner import real_gaunt

random.seed(3)
print("# l m l m l m value; made by gaunt_reference.py with SymPy 1.14")
count = 0
for largest in (6, 20, 70):
    rows = 0
    while rows < 20:
        l1, l2 = random.randint(largest // 2, largest), random.randint(0, largest)
        l3 = random.randrange(abs(l1 - l2), min(l1 + l2, largest) + 1, 2) if abs(l1 - l2) <= largest else None
        m1, m2 = random.randint(-l1, l1), random.randint(-l2, l2)
        size = random.choice((abs(abs(m1) - abs(m2)), abs(m1) + abs(m2)))
        if l3 is None or size > l3:
            continue
        m3 = -size if (m1 < 0) != (m2 < 0) else size
        value = N(real_gaunt(l1, l2, l3, m1, m2, m3), 20)
        if value == 0:
            continue
        print(l1, m1, l2, m2, l3, m3, value)
        rows += 1
