#include "api/report_words.h"

const char *api_format_word(enum mp_format format)
{
	switch (format) {
	case MP_FORMAT_STL_BINARY:
		return "stl-binary";
	case MP_FORMAT_STL_ASCII:
		return "stl-ascii";
	case MP_FORMAT_OBJ:
		return "obj";
	case MP_FORMAT_DRACO:
		return "draco";
	case MP_FORMAT_MIXED:
		return "mixed";
	case MP_FORMAT_UNKNOWN:
		break;
	}
	return "unknown";
}

const char *api_orientation_word(enum mp_orientation orientation)
{
	switch (orientation) {
	case MP_ORIENTATION_OUTWARD:
		return "outward";
	case MP_ORIENTATION_INWARD:
		return "inward";
	case MP_ORIENTATION_MIXED:
		return "mixed";
	case MP_ORIENTATION_NONE:
		break;
	}
	return "none";
}

const char *api_symmetry_word(enum mp_symmetry symmetry)
{
	switch (symmetry) {
	case MP_SYMMETRY_AXIAL:
		return "axial";
	case MP_SYMMETRY_SPHERICAL:
		return "spherical";
	case MP_SYMMETRY_NONE:
		break;
	}
	return "none";
}

const char *api_precision_word(enum mp_precision precision)
{
	return precision == MP_PRECISION_EXACT ? "exact" : "certified";
}
