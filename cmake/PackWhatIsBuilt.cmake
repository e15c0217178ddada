# Read by cpack before it packs: leaves the programs out where they are not built.
if(NOT EXISTS ${CPACK_PLUMBLINE_PROGRAM})
  list(REMOVE_ITEM CPACK_COMPONENTS_ALL programs)
endif()
