# Usage: cmake -D OUTPUT=<x.cc> -D HEADER=<include path> -D "TEXTS=<constant>=<file>;..."
#              -P EmbedText.cmake
# Writes a source file that holds each text in the constant of that name, which the header declares.
cmake_minimum_required(VERSION 3.18)

set(source "#include \"${HEADER}\"\n\nnamespace plumbline {\n")
foreach(text IN LISTS TEXTS)
  string(REGEX MATCH "^([^=]+)=(.+)$" matched "${text}")
  set(constant ${CMAKE_MATCH_1})
  file(READ ${CMAKE_MATCH_2} content)
  string(APPEND source "\nconst char* const ${constant} = R\"plumbline(${content})plumbline\";\n")
endforeach()
file(WRITE ${OUTPUT} "${source}\n}  // namespace plumbline\n")
