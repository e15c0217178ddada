#include "plumbline/apps/dds/bytes_type.h"

#include <dds/ddsi/ddsi_serdata.h>
#include <dds/ddsi/ddsi_sertype.h>
#include <dds/ddsi/q_radmin.h>

#include <algorithm>
#include <cstddef>
#include <cstring>
#include <utility>

// The operations that Cyclone DDS asks of a type (dds/ddsi/ddsi_sertype.h) and of its samples
// (dds/ddsi/ddsi_serdata.h). There are no keys: all samples of a topic are one instance.

namespace plumbline {
namespace {

constexpr std::size_t kMaxSampleBytes = std::size_t{64} << 20;

struct BytesSample : ddsi_serdata {
  std::string bytes;  // filled up to a multiple of 4, as the protocol sends them
};

const BytesSample* AsBytes(const ddsi_serdata* sample) {
  return static_cast<const BytesSample*>(sample);
}

BytesSample* NewSample(const ddsi_sertype* type, ddsi_serdata_kind kind, std::string bytes) {
  auto* sample = new BytesSample;
  ddsi_serdata_init(sample, type, kind);
  sample->hash = type->serdata_basehash;
  sample->bytes = std::move(bytes);
  sample->bytes.resize((sample->bytes.size() + 3) / 4 * 4);
  return sample;
}

bool HaveEqualKeys(const ddsi_serdata*, const ddsi_serdata*) { return true; }

uint32_t SizeOf(const ddsi_serdata* sample) {
  return static_cast<uint32_t>(AsBytes(sample)->bytes.size());
}

// Fragments are in order of their first byte and may overlap.
ddsi_serdata* FromFragments(const ddsi_sertype* type, ddsi_serdata_kind kind,
                            const nn_rdata* fragment, std::size_t size) {
  std::string bytes;
  const std::size_t wanted = std::min(size, kMaxSampleBytes);
  bytes.reserve(wanted);
  for (; fragment != nullptr && bytes.size() < wanted; fragment = fragment->nextfrag) {
    if (fragment->maxp1 <= bytes.size() || fragment->min > bytes.size()) continue;
    const std::size_t skipped = bytes.size() - fragment->min;
    const std::size_t end = std::min<std::size_t>(fragment->maxp1, wanted);
    const unsigned char* payload =
        NN_RMSG_PAYLOADOFF(fragment->rmsg, NN_RDATA_PAYLOAD_OFF(fragment));
    bytes.append(reinterpret_cast<const char*>(payload) + skipped, end - bytes.size());
  }
  return NewSample(type, kind, std::move(bytes));
}

ddsi_serdata* FromParts(const ddsi_sertype* type, ddsi_serdata_kind kind, ddsrt_msg_iovlen_t num,
                        const ddsrt_iovec_t* parts, std::size_t) {
  std::string bytes;
  for (ddsrt_msg_iovlen_t i = 0; i < num; ++i) {
    bytes.append(static_cast<const char*>(parts[i].iov_base), parts[i].iov_len);
  }
  return NewSample(type, kind, std::move(bytes));
}

ddsi_serdata* FromKeyHash(const ddsi_sertype* type, const ddsi_keyhash*) {
  return NewSample(type, SDK_KEY, {});
}

ddsi_serdata* FromSample(const ddsi_sertype* type, ddsi_serdata_kind kind, const void* sample) {
  return NewSample(type, kind,
                   kind == SDK_DATA ? *static_cast<const std::string*>(sample) : std::string());
}

void ToBytes(const ddsi_serdata* sample, std::size_t offset, std::size_t size, void* buffer) {
  std::memcpy(buffer, AsBytes(sample)->bytes.data() + offset, size);
}

ddsi_serdata* ToBytesReference(const ddsi_serdata* sample, std::size_t offset, std::size_t size,
                               ddsrt_iovec_t* reference) {
  reference->iov_base = const_cast<char*>(AsBytes(sample)->bytes.data()) + offset;
  reference->iov_len = size;
  return ddsi_serdata_ref(sample);
}

void DropBytesReference(ddsi_serdata* sample, const ddsrt_iovec_t*) { ddsi_serdata_unref(sample); }

bool ToSample(const ddsi_serdata* data, void* sample, void**, void*) {
  if (data->kind == SDK_DATA) *static_cast<std::string*>(sample) = AsBytes(data)->bytes;
  return true;
}

ddsi_serdata* ToUntyped(const ddsi_serdata* sample) {
  BytesSample* untyped = NewSample(sample->type, SDK_KEY, {});
  untyped->type = nullptr;
  return untyped;
}

bool FromUntyped(const ddsi_sertype*, const ddsi_serdata*, void*, void**, void*) { return true; }

void FreeData(ddsi_serdata* sample) { delete static_cast<BytesSample*>(sample); }

std::size_t PrintData(const ddsi_sertype*, const ddsi_serdata*, char* buffer, std::size_t size) {
  if (size > 0) buffer[0] = '\0';
  return 0;
}

void KeyHashOf(const ddsi_serdata*, ddsi_keyhash* hash, bool) { *hash = ddsi_keyhash(); }

ddsi_serdata_ops MakeSampleOperations() {
  ddsi_serdata_ops operations = {};
  operations.eqkey = HaveEqualKeys;
  operations.get_size = SizeOf;
  operations.from_ser = FromFragments;
  operations.from_ser_iov = FromParts;
  operations.from_keyhash = FromKeyHash;
  operations.from_sample = FromSample;
  operations.to_ser = ToBytes;
  operations.to_ser_ref = ToBytesReference;
  operations.to_ser_unref = DropBytesReference;
  operations.to_sample = ToSample;
  operations.to_untyped = ToUntyped;
  operations.untyped_to_sample = FromUntyped;
  operations.free = FreeData;
  operations.print = PrintData;
  operations.get_keyhash = KeyHashOf;
  return operations;
}

void FreeType(ddsi_sertype* type) {
  ddsi_sertype_fini(type);
  delete type;
}

// Loans of samples, which nobody asks for.
void ZeroSamples(const ddsi_sertype*, void*, std::size_t) {}
void ReallocateSamples(void** samples, const ddsi_sertype*, void*, std::size_t, std::size_t count) {
  std::fill(samples, samples + count, nullptr);
}
void FreeSamples(const ddsi_sertype*, void**, std::size_t, dds_free_op_t) {}

// Types of one name are one type.
bool AreEqualTypes(const ddsi_sertype*, const ddsi_sertype*) { return true; }
uint32_t HashOfType(const ddsi_sertype*) { return 0; }

ddsi_sertype_ops MakeTypeOperations() {
  ddsi_sertype_ops operations = {};
  operations.version = ddsi_sertype_v0;
  operations.free = FreeType;
  operations.zero_samples = ZeroSamples;
  operations.realloc_samples = ReallocateSamples;
  operations.free_samples = FreeSamples;
  operations.equal = AreEqualTypes;
  operations.hash = HashOfType;
  return operations;
}

}  // namespace

dds_entity_t CreateBytesTopic(dds_entity_t participant, const std::string& topic_name,
                              const std::string& type_name) {
  static const ddsi_serdata_ops sample_operations = MakeSampleOperations();
  static const ddsi_sertype_ops type_operations = MakeTypeOperations();
  auto* type = new ddsi_sertype();
  ddsi_sertype_init(type, type_name.c_str(), &type_operations, &sample_operations, true);
  type->allowed_data_representation = DDS_DATA_REPRESENTATION_FLAG_XCDR1;
  const dds_entity_t topic =
      dds_create_topic_sertype(participant, topic_name.c_str(), &type, nullptr, nullptr, nullptr);
  if (topic < 0) ddsi_sertype_unref(type);
  return topic;
}

}  // namespace plumbline
