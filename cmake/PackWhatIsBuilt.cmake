# Read by cpack before it packs: leaves out the readers and the programs where they are not built.
if(NOT EXISTS ${CPACK_PLUMBLINE_IO})
  list(REMOVE_ITEM CPACK_COMPONENTS_ALL io)
endif()
if(NOT EXISTS ${CPACK_PLUMBLINE_PROGRAM})
  list(REMOVE_ITEM CPACK_COMPONENTS_ALL programs)
endif()
