#ifndef MP_ANALYSIS_STATE_H
#define MP_ANALYSIS_STATE_H

#include "core/analysis.h"
#include "core/bodies/parts.h"
#include "core/fingerprint/fingerprint.h"
#include "core/format.h"
#include "core/moments/moments.h"
#include "core/topology/index.h"

/* The inside of an analysis: analysis.c fills it while bytes come, report.c reads it at the end. */
struct mp_analysis {
	struct mp_request request;
	const struct mp_decoder_ops *decoder; /* NULL until the format is known */
	void *state;                          /* the decoder's */
	struct mp_sink sink;
	struct mp_notes notes;  /* of the file in work; of all of them when they have ended */
	struct mp_notes before; /* of the files that ended */
	size_t first;           /* triangle number at which the file in work begins */

	uint8_t head[MP_SNIFF_BYTES]; /* the first bytes, until the format is known */
	size_t head_len;

	struct mp_moments moments; /* the sums, as in the file (not flipped) */
	bool not_stl;              /* some file was for another decoder */
	bool streamed; /* checks=closed: of all below, up to names, only triangles is used */
	struct mp_fingerprint fingerprint; /* if streamed */
	uint64_t degenerate;               /* if streamed */
	bool edges;                        /* if streamed: some triangle has three corners */
	struct mp_vertices *vertices;
	uint32_t (*tri)[3];
	uint64_t
	    *flat; /* mp_flat_mark() of them: good for as long as no vertex is moved or merged */
	size_t triangles, room;
	struct mp_names names;
	bool has_material; /* the file in work */
	struct mp_index index;
	const uint32_t (*numbers)[3]; /* of the block to come, in its file; NULL: none */
	struct mp_by_index by_index;  /* when ended; not yet compared */
	bool ended; /* mp_analysis_end() returned 0, and no report took the mesh yet */
};

#endif
