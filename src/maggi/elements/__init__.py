"""One finite element in a moving frame (T1–T4): shapes, quadrature, inertia integrals, fast assembly."""
