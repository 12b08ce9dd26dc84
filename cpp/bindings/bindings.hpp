/// @file
/// Functions that bind parts of the core, called in the order of its layers.
#pragma once

#include <pybind11/pybind11.h>

void bind_geometry(pybind11::module_& m);
void bind_joints(pybind11::module_& m);
void bind_model(pybind11::module_& m);
void bind_assembly(pybind11::module_& m);
void bind_splines(pybind11::module_& m);
void bind_simulation(pybind11::module_& m);
void bind_stepping(pybind11::module_& m);
void bind_solids(pybind11::module_& m);
void bind_reduction(pybind11::module_& m);
