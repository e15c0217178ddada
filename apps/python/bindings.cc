// The extension of the Python package `plumbline`, see README.md.

#include "plumbline/apps/python/bindings.h"

PYBIND11_MODULE(_plumbline, module) {
  // Classes and errors are known by the name of the package.
  module.attr("__name__") = "plumbline";
  plumbline::BindErrors(&module);
  plumbline::BindGraph(&module);
  plumbline::BindOptions(&module);
  plumbline::BindSummaries(&module);
  plumbline::BindSeedReports(&module);
  plumbline::BindSolvers(&module);
  plumbline::BindIncrementalSolver(&module);
  plumbline::BindMapLog(&module);
  plumbline::BindOnlineMapper(&module);
  plumbline::BindFiles(&module);
  plumbline::BindEvaluation(&module);
  module.attr("__name__") = "plumbline._plumbline";
}
