#ifndef PLUMBLINE_APPS_PYTHON_BINDINGS_H_
#define PLUMBLINE_APPS_PYTHON_BINDINGS_H_

#include <pybind11/pybind11.h>

namespace plumbline {

/// @{
/// Each defines a part of the module; what a signature names has to be defined before it.
void BindErrors(pybind11::module_* module);             ///< what is raised
void BindGraph(pybind11::module_* module);              ///< poses, lasers, graphs and states
void BindOptions(pybind11::module_* module);            ///< all that is an option
void BindSummaries(pybind11::module_* module);          ///< how a solve went
void BindSeedReports(pybind11::module_* module);        ///< how a seed was found
void BindSolvers(pybind11::module_* module);            ///< from a state to a better one
void BindIncrementalSolver(pybind11::module_* module);  ///< the same while a graph grows
void BindMapLog(pybind11::module_* module);             ///< from a log to a map
void BindOnlineMapper(pybind11::module_* module);       ///< the same while the robot drives
void BindFiles(pybind11::module_* module);              ///< readers and writers
void BindEvaluation(pybind11::module_* module);         ///< how good a result is
/// @}

}  // namespace plumbline

#endif  // PLUMBLINE_APPS_PYTHON_BINDINGS_H_
