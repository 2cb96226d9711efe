@definitions@
static void rulec_read_world(const rulec_input *in, uint16_t *digits)
{
    @world@
}

static void rulec_read_own(const rulec_input *in, size_t one, uint16_t *digits)
{
    @own@
}

static uint16_t rulec_read_together(
    const rulec_input *in, const size_t *who, uint16_t read)
{
    @together@
    return digits;
}

void rulec_input_defaults(rulec_input *input)
{
    input->n_objects = 0u;
    input->objects = NULL;
    @input_defaults@
}

void rulec_object_defaults(rulec_object *object, uint32_t id, uint8_t type)
{
    object->id = id;
    object->type = type;
    @object_defaults@
}

void rulec_input_unknown(rulec_input *input)
{
    input->n_objects = 0u;
    input->objects = NULL;
    @input_unknown@
}

void rulec_object_unknown(rulec_object *object, uint32_t id, uint8_t type)
{
    object->id = id;
    object->type = type;
    @object_unknown@
}
