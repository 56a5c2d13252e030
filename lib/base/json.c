/* A JSON writer: two-space indentation, one member a line. */
#include "base/json.h"

#include "base/alloc.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

static void release_text(gtx_json *json)
{
    gtx_allocator allocator = gtx_allocator_or_default(&json->allocator);
    gtx_free_array(&allocator, json->text, json->capacity, 1);
}

static bool grow(gtx_json *json, size_t capacity)
{
    gtx_allocator allocator = gtx_allocator_or_default(&json->allocator);
    char *grown = gtx_alloc_array(&allocator, capacity, 1);
    if (!grown)
        return false;
    if (json->size)
        memcpy(grown, json->text, json->size);
    release_text(json);
    json->text = grown;
    json->capacity = capacity;
    return true;
}

static void append(gtx_json *json, const char *text, size_t size)
{
    if (json->failed)
        return;
    size_t needed = json->size + size + 1;
    if (needed > json->capacity && !grow(json, 2 * needed + 64)) {
        json->failed = true;
        return;
    }
    memcpy(json->text + json->size, text, size);
    json->size += size;
    json->text[json->size] = 0;
}

static void append_string(gtx_json *json, const char *value)
{
    append(json, "\"", 1);
    for (const char *p = value; *p; ++p) {
        unsigned char c = (unsigned char)*p;
        char escaped[8];
        if (c == '"' || c == '\\') {
            escaped[0] = '\\';
            escaped[1] = (char)c;
            append(json, escaped, 2);
        } else if (c < 0x20) {
            append(json, escaped, (size_t)snprintf(escaped, sizeof escaped, "\\u%04x", c));
        } else {
            append(json, p, 1);
        }
    }
    append(json, "\"", 1);
}

static void new_line(gtx_json *json)
{
    if (json->depth)
        append(json, "\n", 1);
    for (unsigned i = 0; i < json->depth; ++i)
        append(json, "  ", 2);
}

static void begin_value(gtx_json *json, const char *key)
{
    if (json->comma)
        append(json, ",", 1);
    new_line(json);
    json->comma = true;
    if (key) {
        append_string(json, key);
        append(json, ": ", 2);
    }
}

static void begin_nest(gtx_json *json, const char *key, const char *bracket)
{
    begin_value(json, key);
    append(json, bracket, 1);
    json->depth++;
    json->comma = false;
}

static void end_nest(gtx_json *json, const char *bracket)
{
    bool empty = !json->comma;
    json->depth--;
    if (!empty) {
        append(json, "\n", 1);
        for (unsigned i = 0; i < json->depth; ++i)
            append(json, "  ", 2);
    }
    append(json, bracket, 1);
    json->comma = true;
    if (json->depth == 0)
        append(json, "\n", 1);
}

void gtx_json_begin_object(gtx_json *json, const char *key)
{
    begin_nest(json, key, "{");
}

void gtx_json_end_object(gtx_json *json)
{
    end_nest(json, "}");
}

void gtx_json_begin_array(gtx_json *json, const char *key)
{
    begin_nest(json, key, "[");
}

void gtx_json_end_array(gtx_json *json)
{
    end_nest(json, "]");
}

void gtx_json_string(gtx_json *json, const char *key, const char *value)
{
    begin_value(json, key);
    append_string(json, value);
}

static void write_number(gtx_json *json, const char *key, double value, int digits)
{
    char text[40];
    if (!isfinite(value)) {
        gtx_json_null(json, key);
        return;
    }
    int size = snprintf(text, sizeof text, "%.*g", digits, value);
    for (char *p = text; *p; ++p)
        if (*p == ',') /* the decimal point of some locales */
            *p = '.';
    begin_value(json, key);
    append(json, text, (size_t)size);
}

void gtx_json_number(gtx_json *json, const char *key, double value)
{
    write_number(json, key, value, 9);
}

void gtx_json_exact(gtx_json *json, const char *key, double value)
{
    write_number(json, key, value, 17);
}

void gtx_json_integer(gtx_json *json, const char *key, uint64_t value)
{
    char text[24];
    begin_value(json, key);
    append(json, text, (size_t)snprintf(text, sizeof text, "%llu", (unsigned long long)value));
}

void gtx_json_bool(gtx_json *json, const char *key, bool value)
{
    begin_value(json, key);
    append(json, value ? "true" : "false", value ? 4 : 5);
}

void gtx_json_hash(gtx_json *json, const char *key, uint64_t value)
{
    char text[24];
    snprintf(text, sizeof text, "0x%016llx", (unsigned long long)value);
    gtx_json_string(json, key, text);
}

void gtx_json_null(gtx_json *json, const char *key)
{
    begin_value(json, key);
    append(json, "null", 4);
}

void gtx_json_free(gtx_json *json)
{
    release_text(json);
    *json = (gtx_json){.allocator = json->allocator};
}
