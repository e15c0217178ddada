#ifndef PLUMBLINE_APPS_PYTHON_MAPPING_H_
#define PLUMBLINE_APPS_PYTHON_MAPPING_H_

#include <pybind11/pybind11.h>

#include "plumbline/solvers/map_log.h"

namespace plumbline {

/// A LogMapping as Python has it.
pybind11::object MappingOf(LogMapping mapping);

}  // namespace plumbline

#endif  // PLUMBLINE_APPS_PYTHON_MAPPING_H_
