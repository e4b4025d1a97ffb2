#ifndef MP_DRACO_HEAD_H
#define MP_DRACO_HEAD_H

#include "core/decoder.h"

/*
 * What a Draco file says about itself, read before libdraco gets to see it: kind and version as
 * soon as they are there, the declared counts once the file is whole.  The format has no other
 * specification than https://google.github.io/draco/spec/ (bitstream 2.2) and the reader.
 */

enum {
	MP_DRACO_MAJOR = 5, /* where the version's first number stands */
	MP_DRACO_KIND = 9,  /* bytes that tell kind and version: magic, 2 * version, kind, method */
	MP_DRACO_HEAD = 11  /* with the flags */
};

/*
 * 0 for a mesh of a version that is read; -1 with MP_SYNTAX (no Draco), MP_POINT_CLOUD or
 * MP_UNSUPPORTED.
 */
int mp_draco_check_kind(const uint8_t file[MP_DRACO_KIND], struct mp_error *err);

/*
 * Judge the declared numbers of faces and symbols by the ${len} bytes of the whole file, for which
 * mp_draco_check_kind() returned 0.  -1: MP_TRUNCATED where the file cannot be long enough for
 * them, MP_LIMIT where it can and they are more than ${limits} allow, MP_NO_FACES.
 */
int mp_draco_check_counts(const uint8_t *file, size_t len, const struct mp_limits *limits,
			  struct mp_error *err);

#endif
