/*
 * The one file of C++: libdraco (Apache-2.0) behind core/draco/draco_wrap.h.  Built and tested
 * with 1.5.5 (Debian 12) and 1.5.6 (Debian 13).
 */
#include "core/draco/draco_wrap.h"

#include <cstring>
#include <memory>
#include <new>
#include <stdexcept>
#include <type_traits>

#include <draco/attributes/attribute_quantization_transform.h>
#include <draco/compression/decode.h>
#include <draco/core/decoder_buffer.h>
#include <draco/mesh/mesh.h>

using draco::GeometryAttribute;
using draco::PointAttribute;

struct mp_draco_mesh {
	std::unique_ptr<draco::Mesh> mesh;
	PointAttribute *positions = nullptr; /* the mesh's own */
};

static mp_draco_type type_of(draco::DataType type)
{
	switch (type) {
	case draco::DT_INT8:
		return MP_DRACO_INT8;
	case draco::DT_UINT8:
		return MP_DRACO_UINT8;
	case draco::DT_INT16:
		return MP_DRACO_INT16;
	case draco::DT_UINT16:
		return MP_DRACO_UINT16;
	case draco::DT_INT32:
		return MP_DRACO_INT32;
	case draco::DT_UINT32:
		return MP_DRACO_UINT32;
	case draco::DT_FLOAT32:
		return MP_DRACO_FLOAT32;
	case draco::DT_FLOAT64:
		return MP_DRACO_FLOAT64;
	default: /* 64-bit integers, which doubles do not hold, and booleans */
		return MP_DRACO_OTHER;
	}
}

/* A clause for the end of a sentence of ours: ASCII, without the period. */
static void keep_words(const char *from, char *why, size_t room)
{
	size_t n = 0;

	for (; *from != '\0' && n + 1 < room; from++)
		if (*from >= ' ' && *from <= '~')
			why[n++] = *from;
	while (n > 0 && (why[n - 1] == '.' || why[n - 1] == ' '))
		n--;
	if (room > 0)
		why[n] = '\0';
}

/*
 * ${raw}: leave quantised positions as the integers of the file, with what they mean beside them;
 * libdraco forgets the step otherwise.
 */
static draco::Status decode(const uint8_t *file, size_t len, bool raw, mp_draco_mesh *m,
			    uint64_t *used)
{
	draco::Decoder decoder;
	draco::DecoderBuffer buffer;

	buffer.Init(reinterpret_cast<const char *>(file), len);
	if (raw)
		decoder.SetSkipAttributeTransform(GeometryAttribute::POSITION);
	m->positions = nullptr;
	m->mesh.reset(); /* two meshes at a time are one too many */
	auto result = decoder.DecodeMeshFromBuffer(&buffer);
	if (!result.ok())
		return result.status();
	m->mesh = std::move(result).value();
	const int32_t positions = m->mesh->GetNamedAttributeId(GeometryAttribute::POSITION);
	if (positions >= 0)
		m->positions = m->mesh->attribute(positions);
	*used = buffer.remaining_size() < 0 ? len : len - (uint64_t)buffer.remaining_size();
	return draco::OkStatus();
}

/*
 * From the file's integers to the floats that libdraco makes of them, by libdraco, in their place:
 * it goes over them once, in order.
 */
static bool dequantise(PointAttribute *p, double *step)
{
	draco::AttributeQuantizationTransform transform;

	if (!transform.InitFromAttribute(*p) || p->num_components() != 3 ||
	    p->data_type() != draco::DT_INT32 || p->byte_stride() != 12 || p->byte_offset() != 0 ||
	    p->buffer()->data_size() / 12 < p->size())
		return false;
	p->GeometryAttribute::Init(GeometryAttribute::POSITION, p->buffer(), 3, draco::DT_FLOAT32,
				   false, 12, 0);
	if (!transform.InverseTransformAttribute(*p, p))
		return false;
	*step = (double)transform.range() / (double)((1u << transform.quantization_bits()) - 1);
	return true;
}

static void describe(const mp_draco_mesh *m, mp_draco_shape *shape)
{
	const PointAttribute *held = m->positions;

	shape->faces = m->mesh->num_faces();
	shape->points = m->mesh->num_points();
	shape->has_positions = held != nullptr;
	if (held == nullptr)
		return;
	shape->normalised = held->normalized();
	shape->type = type_of(held->data_type());
	shape->components = (unsigned)held->num_components();
	shape->values = held->size();
	shape->mapped = held->is_mapping_identity() ? shape->points : held->indices_map_size();
	shape->data = held->buffer()->data();
	shape->size = held->buffer()->data_size();
	shape->offset = (uint64_t)held->byte_offset();
	shape->stride = (uint64_t)held->byte_stride();
}

/*
 * Bitstreams before 2.0 predict other attributes from the finished positions, so there the
 * integers cannot be had.  Integer positions come back as int32 whatever the file calls them;
 * they are rare enough to be decoded again.
 */
static draco::Status decode_all(const uint8_t *file, size_t len, mp_draco_mesh *m,
				mp_draco_shape *shape)
{
	bool raw = len > 5 && file[5] >= 2;
	draco::Status status = decode(file, len, raw, m, &shape->used);

	if (status.ok() && raw && m->positions != nullptr &&
	    m->positions->data_type() == draco::DT_INT32 && !dequantise(m->positions, &shape->step))
		status = decode(file, len, false, m, &shape->used);
	return status;
}

mp_draco_verdict mp_draco_decode(const uint8_t *file, size_t len, mp_draco_mesh **out,
				 mp_draco_shape *shape, char *why, size_t room)
try {
	std::unique_ptr<mp_draco_mesh> m(new mp_draco_mesh);

	*out = nullptr;
	*shape = mp_draco_shape();
	keep_words("", why, room);
	draco::Status status = decode_all(file, len, m.get(), shape);
	if (!status.ok()) {
		keep_words(status.error_msg(), why, room);
		return MP_DRACO_REFUSED;
	}
	describe(m.get(), shape);
	*out = m.release();
	return MP_DRACO_DECODED;
} catch (const std::bad_alloc &) {
	*out = nullptr;
	return MP_DRACO_NO_MEMORY;
} catch (const std::length_error &) {
	*out = nullptr;
	return MP_DRACO_NO_MEMORY;
} catch (...) {
	*out = nullptr;
	keep_words("an exception", why, room);
	return MP_DRACO_REFUSED;
}

/* libdraco keeps faces in one vector, each an array of numbers of one member. */
static_assert(sizeof(draco::Mesh::Face) == 3 * sizeof(uint32_t) &&
		  std::is_standard_layout<draco::PointIndex>::value,
	      "three numbers a face");

const uint32_t (*mp_draco_faces(const mp_draco_mesh *mesh))[3]
{
	return reinterpret_cast<const uint32_t(*)[3]>(&mesh->mesh->face(draco::FaceIndex(0)));
}

bool mp_draco_values(const mp_draco_mesh *mesh, const uint32_t (*point)[3], size_t count,
		     uint32_t (*value)[3])
{
	const PointAttribute *held = mesh->positions;

	if (held->is_mapping_identity())
		return false;
	for (size_t i = 0; i < count; i++)
		for (size_t k = 0; k < 3; k++)
			value[i][k] = held->mapped_index(draco::PointIndex(point[i][k])).value();
	return true;
}

void mp_draco_free(mp_draco_mesh *mesh)
{
	delete mesh;
}
