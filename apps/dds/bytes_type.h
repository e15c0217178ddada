#ifndef PLUMBLINE_APPS_DDS_BYTES_TYPE_H_
#define PLUMBLINE_APPS_DDS_BYTES_TYPE_H_

#include <dds/dds.h>

#include <string>

namespace plumbline {

/// Creates a topic of Cyclone DDS whose samples are serialised messages: dds_take and dds_write
/// take pointers to std::string, the bytes of a message with the header of its encoding. Messages
/// longer than 64 MiB are cut off there. type_name: of the messages, by which readers and writers
/// find each other. Returns the topic, or a negative error of Cyclone DDS.
dds_entity_t CreateBytesTopic(dds_entity_t participant, const std::string& topic_name,
                              const std::string& type_name);

}  // namespace plumbline

#endif  // PLUMBLINE_APPS_DDS_BYTES_TYPE_H_
