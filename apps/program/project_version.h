#ifndef PLUMBLINE_APPS_PROGRAM_PROJECT_VERSION_H_
#define PLUMBLINE_APPS_PROGRAM_PROJECT_VERSION_H_

namespace plumbline {

/// Such as "0.1.0". Its source is made when the project is configured.
extern const char* const kProjectVersion;

}  // namespace plumbline

#endif  // PLUMBLINE_APPS_PROGRAM_PROJECT_VERSION_H_
